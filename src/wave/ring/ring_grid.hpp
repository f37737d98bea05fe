// SPDX-License-Identifier: BSD-3-Clause
// The grid of a ring or folded cavity (docs/theory/wave.md, eq. W.5, W.6, W.54).
#pragma once

#include "wave/ring/ring_cavity.hpp"

namespace straytrace::wave {

// Chooses the crossover angle, window, points and scales that the settings do not state, with problems where those
// stated do not carry the light.
void choose_ring_grid(RingCavity&, WaveSettings const&);
// Curvature of the spherical wave that the grid follows behind a stop, and of that which comes to it (eq. W.54). 1/m
double followed_behind(Trip const&, std::size_t stop);
double followed_before(Trip const&, std::size_t stop);
double needed_memory(RingCavity const&);  // bytes, of the fields

}  // namespace straytrace::wave
