// SPDX-License-Identifier: BSD-3-Clause
// The solved field of a ring or folded cavity of a scene: its mode, where its light goes, and what an input beam drives
// (docs/theory/wave.md).
#pragma once

#include "wave/arm/driven_arm.hpp"
#include "wave/ring/ring_levers.hpp"

namespace straytrace::wave {

struct RingWaves {
  RingCavity ring;  // without the heights, which `trip` has
  RoundTrip trip;
  WaveMode mode;
  std::vector<ModeLine> modes;
  TripLosses losses;  // of the stops
  RingLevers levers;
};
// Throws InputError with all errors of the plan.
RingWaves solve_ring(World const&, WaveSettings const&, RingCavity planned, ArmOptions const& = {});

// `coatings` as the mirrors of the settings. InputError if the input beam falls beside the first mirror.
DrivenScan drive_ring(World const&, WaveSettings const&, RingWaves const&, std::vector<MirrorCoating> const& coatings,
                      std::vector<double> const& detunings, DriveOptions const& = {});

}  // namespace straytrace::wave
