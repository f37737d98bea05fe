// SPDX-License-Identifier: BSD-3-Clause
// The grid of a table `wave`, and what cannot be computed: each is an error before any field is allocated.
#pragma once

#include "wave/arm/arm_cavity.hpp"

namespace straytrace::wave {

// Edges that are tilted, or that W.22 does not describe; tolerances as large as the edges. Throws InputError with all
// of them, and adds warnings.
void check_rims(World const&, WaveSettings const&, ArmCavity&);
// Those of the table; otherwise a window as wide as the legs need and the power of two that carries the crossover
// angle.
void choose_grid(ArmCavity&, WaveSettings const&);
// Points, window and memory of the grid.
void check_grid(World const&, ArmCavity&);

// Whether no light of the mode itself meets a rim: 2e-11 of it lies beyond.
bool clear_of_mode(ArmCavity const&, ArmRim const&);

// The next number of points that transforms are fast for, at most 8192; 0: none.
int allowed_points(int least);

}  // namespace straytrace::wave
