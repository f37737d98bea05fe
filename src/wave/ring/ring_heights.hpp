// SPDX-License-Identifier: BSD-3-Clause
// Heights of the mirrors of a ring or folded cavity, as the light that falls on them at an angle sees them
// (docs/theory/wave.md, eq. W.20, W.55).
#pragma once

#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

// The power that its mirrors scatter beyond the crossover angle, and the measured maps, with problems of maps and
// defects.
void plan_ring_heights(RingCavity&, World const&, WaveSettings const&);
// Heights of each mirror below the crossover angle, as its settings have them: measured, random with the spectrum of
// its BSDF, or none; with defects.
void add_ring_heights(RingCavity&, World const&, WaveSettings const&);

}  // namespace straytrace::wave
