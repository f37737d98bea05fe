// SPDX-License-Identifier: BSD-3-Clause
// The table `wave` of a scene: a cavity whose field at small angles is computed by Fourier propagation
// (docs/theory/wave.md).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/memory/ids.hpp"

namespace straytrace::world {

struct WaveSettings {
  // Parts of a height map that a mirror does not keep.
  struct Removed {
    bool piston = true, tilt = true, curvature = false, astigmatism = false;
    bool operator==(Removed const&) const = default;
  };
  enum class Heights {
    material,  // random, with the spectrum that gives the BSDF of the mirror
    none,      // a perfect mirror
    file       // measured
  };
  // A spot of 1/e^2 radius `radius` that absorbs light and heats the surface, which bulges: eq. W.31.
  struct Absorber {
    double x = 0, y = 0, radius = 0;  // m
    double rise = 0;                  // absorbed power times the bulge per power, m
  };
  struct Ripple {
    double amplitude = 0, period = 0;  // peak, m
    double direction = 0;              // of its wave vector, from x towards y, rad
  };
  struct Mirror {
    SurfaceId surface;
    std::string name;  // its key in `maps`
    Heights heights = Heights::material;
    std::string file;   // as the scene names it, for messages
    std::string bytes;  // its content
    std::uint64_t seed = 1;
    Removed removed;
    std::vector<Absorber> absorbers;
    std::vector<Ripple> ripples;
    // Static misalignment, along x and y of the frame of the cavity: lean of the normal of the lit side, rad; place of
    // the mirror, m.
    std::array<double, 2> tilt{}, shift{};
    std::optional<double> transmission;  // of power; none: that of the interferometer
    double loss = 0;                     // of power, beside what the field of the cavity loses
    bool misaligned() const { return tilt[0] != 0 || tilt[1] != 0 || shift[0] != 0 || shift[1] != 0; }
  };
  // The beam that comes in through the first mirror, behind it; none: the mode of the cavity.
  struct Input {
    std::optional<double> radius, wavefront_curvature;  // 1/e^2 of intensity, m; 1/m, positive when it diverges; none:
                                                        // those of the mode of the mirrors
    std::array<double, 2> tilt{}, shift{};              // of the direction of travel, rad; of the spot, m
  };
  // Standard deviations of the inner edges, drawn for each baffle, m.
  struct Tolerance {
    double radius = 0;
    double centre = 0;  // of each coordinate across the beam
    double place = 0;   // along the beam
    bool any() const { return radius > 0 || centre > 0 || place > 0; }
  };

  // Photodiodes of one kind on a screen, about the centre of its opening.
  struct Photodiodes {
    enum class Shape { square, round, sector };
    struct Place {
      double radius = 0, azimuth = 0;  // m; rad from x towards y of the frame of the cavity
    };
    std::string name;
    SurfaceId on;             // a baffle of `groups`, or a mirror
    std::size_t towards = 0;  // number of the mirror towards which the light travels
    Shape shape = Shape::square;
    double size = 0;  // side, diameter, or extent of a sector along the radius. m
    std::vector<Place> places;
  };

  bool present = false;
  std::uint32_t beam = 0;  // number of the cavity, as in its footprints
  std::string beam_name;
  bool ring = false;                                     // of three mirrors or more: a ring or a folded cavity
  std::vector<Mirror> mirrors = std::vector<Mirror>(2);  // in the order of `cavity`, each once
  std::optional<double> crossover;                       // rad; none: chosen by the computation
  std::vector<std::string> groups;                       // entries of the scene whose inner rims the field passes
  std::uint32_t points = 0;                              // of the grid, along one side; 0: chosen by the computation
  double window = 0;                                     // m, side of the grid; 0: chosen by the computation
  Tolerance tolerance;
  std::uint32_t draws = 1;      // of the tolerances and of the roll of a mirror, in each draw of the heights
  std::uint32_t map_draws = 1;  // of the random heights of the mirrors
  std::optional<Input> input;
  std::vector<Photodiodes> photodiodes;

  // Whether the field is that of one of many mirrors, rather than that of measured or perfect ones.
  bool random() const {
    return std::ranges::any_of(mirrors, [](Mirror const& m) { return m.heights == Heights::material; });
  }
  // Random mirrors scatter alike in all azimuths, so that the light of one may be turned about the axis against that of
  // the other, as if the mirror had another roll: a draw that needs no other field. The number of the mirror whose
  // light is turned; none where the heights of both are known, the only random one has defects, or one is misaligned.
  std::optional<std::size_t> rolled() const {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < mirrors.size(); ++i) {
      if (mirrors[i].misaligned()) return {};
      if (mirrors[i].heights == Heights::material && mirrors[i].absorbers.empty() && mirrors[i].ripples.empty())
        found = i;
    }
    return found;
  }
};

}  // namespace straytrace::world
