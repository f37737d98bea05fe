// SPDX-License-Identifier: BSD-3-Clause
// What edges and mirrors of a ring or folded cavity couple back into its mode when they move (docs/theory/wave.md, eq.
// W.56 to W.58).
#pragma once

#include <functional>
#include <vector>

#include "wave/rims.hpp"
#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

// Of a baffle or a mirror, summed over all places where the light meets it. Derivatives of s along the axes of the
// scene; the phase of the axis itself is left out.
struct SurfaceLevers {
  SurfaceId surface;
  bool mirror = false;
  Vec3 reference;    // centre of the edge, or vertex of the mirror: rotations are about it. m
  RimLevers levers;  // as of RimLevers, with each light counted where it passes
  Complex widening;  // of an edge: by its radius, 1/m
};
// The same with rotations about another point.
RimLevers levers_about(SurfaceLevers const&, Vec3 point);

struct RingLevers {
  Complex overlap;                      // B of eq. W.56
  Complex eigenvalue;                   // of the field the other way around, that of the mode
  double residual = 0;                  // of that field (eq. W.9)
  std::vector<SurfaceLevers> surfaces;  // as the light meets them first
};

// The way of the light in the other direction: its round trip is the transpose of that of the trip, and stop i of n is
// stop n - 2 - i of it; the last remains the last, with the coordinates behind it.
Trip reversed(Trip const&);

// Of a cavity with its heights, whose round trip and mode these are.
RingLevers ring_levers(World const&, RingCavity const&, RoundTrip const&, WaveMode const&, SolveOptions const&);

}  // namespace straytrace::wave
