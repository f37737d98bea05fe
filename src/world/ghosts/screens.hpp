// SPDX-License-Identifier: BSD-3-Clause
// Screens: surfaces beside the chief ray that clip a beam between one surface and the next, such as the plate around a
// hole or an edge beside the beam (docs/theory/ghosts.md; docs/theory/beams.md, eq. 5.5, 5.6).
#pragma once

#include <cstdint>
#include <vector>

#include "beams/mode.hpp"
#include "world/model/view.hpp"

namespace straytrace::world {

// From the surface left (invalid: from space) to the next one (invalid: the beam leaves the scene).
struct BeamFlight {
  Mode mode;  // at its start
  Departure from;
  Hit to;
  std::uint32_t volume = Surface::none;  // that contains it; inside glass only the faces of the glass count
  double least = 1e-17;                  // smaller shares are ignored
};

struct Screened {
  SurfaceId surface;
  double share = 0;    // of the power at the start: taken by this surface and by none before it
  double alone = 0;    // the same without the other screens
  double nearest = 0;  // rho (BeamLines) below which it takes nothing
  double along = 0;    // m, from the start
  Mode mode;           // at that distance; its origin is on the chief ray
  Vec3 point;          // an illuminated point of the surface
  std::uint32_t piece = 0;
};

struct FlightLoss {
  std::vector<Screened> screens;  // in the order in which the beam passes them
  double beside = -1;             // share of the arriving power that passes beside the next surface; < 0: unknown
  double taken() const {
    double sum = 0;
    for (Screened const& s : screens) sum += s.share;
    return sum;
  }
};

// Bounds of all surfaces, in a tree of balls.
class Screens {
 public:
  explicit Screens(WorldView const&);
  // The first screen that a line of the beam meets removes that line; at the next surface the beam counts as a complete
  // Gaussian again. On surfaces that are not flat, features narrower than 0.14 beam radii may be missed.
  FlightLoss loss(BeamFlight const&) const;
  // Surfaces that beams of this flight may meet within `reach` radii.
  std::vector<SurfaceId> near(BeamFlight const&, double reach) const;

 private:
  struct Bounds {
    SurfaceId surface;
    Vec3 centre, reference, axis;  // m
    double radius = 0;
    Extent extent;
    std::uint32_t volume = Surface::none;
  };
  struct Node {
    Vec3 centre;
    double radius = 0;
    std::uint32_t first = 0, count = 0, right = 0;  // count 0: the left child follows, `right` is the other
  };
  struct Tube;
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  void collect(Tube const&, std::uint32_t node, std::vector<SurfaceId>&) const;
  bool clear(Tube const&, Bounds const&, double low, double high) const;

  WorldView view_;
  std::vector<Bounds> bounds_;
  std::vector<Node> nodes_;
};

}  // namespace straytrace::world
