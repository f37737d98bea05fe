// SPDX-License-Identifier: BSD-3-Clause
// The solved field of a ring or folded cavity of a scene: its mode and where its light goes (docs/theory/wave.md).
#pragma once

#include "wave/arm/arm_waves.hpp"
#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

struct RingWaves {
  RingCavity ring;
  WaveMode mode;
  std::vector<ModeLine> modes;
  TripLosses losses;  // of the stops
};
// Throws InputError with all errors of the plan.
RingWaves solve_ring(World const&, WaveSettings const&, RingCavity planned, ArmOptions const& = {});

}  // namespace straytrace::wave
