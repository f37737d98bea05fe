// SPDX-License-Identifier: BSD-3-Clause
// Heights of the mirrors of a ring or folded cavity, as the light that falls on them at an angle sees them
// (docs/theory/wave.md, eq. W.20, W.55).
#pragma once

#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

// Random heights with the spectrum of the BSDF of each mirror, unless the settings make it perfect.
void add_ring_heights(RingCavity&, World const&, WaveSettings const&);
// The power that its mirrors scatter beyond the crossover angle.
void add_scattered(RingCavity&, World const&);

}  // namespace straytrace::wave
