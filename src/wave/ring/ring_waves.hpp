// SPDX-License-Identifier: BSD-3-Clause
// The solved field of a ring or folded cavity of a scene: its mode, where its light goes, and what an input beam drives
// (docs/theory/wave.md).
#pragma once

#include <optional>

#include "wave/arm/driven_arm.hpp"
#include "wave/ring/ring_levers.hpp"

namespace straytrace::wave {

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
