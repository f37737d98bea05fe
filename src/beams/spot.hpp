// SPDX-License-Identifier: BSD-3-Clause
// Where a beam of the beam tree meets a surface (world/ghosts/beam_tree.hpp): the main beam (order 0) and its ghosts.
#pragma once

#include <array>
#include <cstdint>

#include "base/memory/ids.hpp"
#include "beams/mode.hpp"
#include "optics/polarisation.hpp"

namespace straytrace::beams {

// Field along the chief ray without the phase of the flight, for light of one state of polarisation, or for two states
// at right angles of which unpolarised light is the even mixture. Power: the mean over the states of |a|^2 + |b|^2.
struct BeamField {
  Vec3 axis{1, 0, 0};  // unit vector across the travel: `a` lies along it, `b` along travel x axis
  std::array<Jones, 2> state;
  int states = 1;
  double power() const {
    double sum = 0;
    for (int i = 0; i < states; ++i) sum += norm(state[i].a) + norm(state[i].b);
    return sum / states;
  }
};

struct BeamSpot {
  static constexpr std::uint32_t none = 0xffffffffu;
  SurfaceId surface;
  std::uint32_t piece = 0;  // of a surface made of pieces
  bool front = true;        // met on the side the normal points to
  Vec3 normal;              // unit, towards the side the light comes from
  Mode mode;           // arriving; its origin is where the chief ray meets the surface; wavelength in the medium there
  double index = 1;    // of that medium
  double power = 0;    // arriving, over that of the launched beam, before the rim clips it
  double clipped = 0;  // share of `power` that misses the surface (docs/theory/beams.md, eq. 5.5, 5.6)
  double path_length = 0;       // optical, from the plane where the beam is launched, m
  double gouy = 0;              // lag of the phase behind that of a plane wave since there, rad
  BeamField field;              // arriving: |.|^2 = power
  std::uint32_t parent = none;  // number of the spot it came from, in the order of the tree
  Event event = Event::start;   // what happened there: start (launched), reflect, transmit
  std::uint32_t order = 0;      // departures from the main beam
  // Phase of the arriving field on the chief ray without that of `field`, rad.
  double phase(double vacuum_wavelength) const { return 2 * pi / vacuum_wavelength * path_length - gouy; }
};

}  // namespace straytrace::beams
