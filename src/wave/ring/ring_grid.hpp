// SPDX-License-Identifier: BSD-3-Clause
// The grid of a ring or folded cavity (docs/theory/wave.md, eq. W.5, W.6, W.54).
#pragma once

#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

// Chooses the crossover angle, window, points and scales that the settings do not state, with problems where those
// stated do not carry the light.
void choose_ring_grid(RingCavity&, WaveSettings const&);
double needed_memory(RingCavity const&);  // bytes, of the fields

}  // namespace straytrace::wave
