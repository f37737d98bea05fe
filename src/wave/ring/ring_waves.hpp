// SPDX-License-Identifier: BSD-3-Clause
// The solved field of a ring or folded cavity of a scene: its mode, where its light goes, and what an input beam drives
// (docs/theory/wave.md).
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "wave/arm/arm_waves.hpp"
#include "wave/cavity_rims.hpp"
#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

// What edges and mirrors of a ring or folded cavity couple back into its mode when they move (docs/theory/wave.md, eq.
// W.56 to W.58).

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

// Results on a grid of some 1.4 times the points, less those on the grid itself.
struct RingGridCheck {
  int points = 0;      // of the finer grid, along one side
  double loss = 0;     // of power per round trip
  TripLosses losses;   // the same, by stop
  double phase = 0;    // largest change of the phase of a mode, turns; NaN: no modes
  double edges = 0;    // largest change of |A_T| of an edge, over the rms of the edges (eq. W.56); NaN: no edges
  double mirrors = 0;  // the same of mirrors (eq. W.57)
};

struct RingWaves {
  RingCavity ring;  // without the heights, which `trip` has
  RoundTrip trip;
  WaveMode mode;
  std::vector<ModeLine> modes;
  TripLosses losses;  // of the stops
  RingLevers levers;
  std::optional<RingGridCheck> grid_check;  // where the options want it
};
// Throws InputError with all errors of the plan.
RingWaves solve_ring(World const&, WaveSettings const&, RingCavity planned, ArmOptions const& = {});

// `coatings` as the mirrors of the settings. InputError if the input beam falls beside the first mirror.
DrivenScan drive_ring(World const&, WaveSettings const&, RingWaves const&, std::vector<MirrorCoating> const& coatings,
                      std::vector<double> const& detunings, DriveOptions const& = {});

}  // namespace straytrace::wave
