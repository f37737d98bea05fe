// SPDX-License-Identifier: BSD-3-Clause
// The grid of a table `wave`, and what cannot be computed: found before any field is allocated, as problems of the
// plan.
#pragma once

#include "wave/arm/arm_cavity.hpp"

namespace straytrace::wave {

// Edges that are tilted, or that W.22 does not describe; tolerances as large as the edges.
void check_rims(World const&, WaveSettings const&, ArmCavity&);
// Mirrors that are shifted by more than their radius; false where one is, so that no axis is worth a check.
bool check_shifts(World const&, WaveSettings const&, ArmCavity&);
// Mirrors whose tilts and shifts take the mode off them.
void check_alignment(World const&, ArmCavity&);
// An input beam that falls beside the first mirror.
void check_input(World const&, WaveSettings const&, ArmCavity&);
// Those of the table; otherwise a window as wide as the legs need, and the power of two that carries the crossover
// angle, light from the outlines of mirrors to edges (eq. W.64), and light between the edges of neighbouring baffles
// that clip the mode.
void choose_grid(ArmCavity&, WaveSettings const&);
// Points, window and memory of the grid.
void check_grid(World const&, WaveSettings const&, ArmCavity&);
// BSDF models that begin beyond the crossover angle; measured maps, which are read here.
void check_mirrors(World const&, WaveSettings const&, ArmCavity&);

// The map of a mirror that states a file, with problems where it cannot be used.
std::optional<HeightMap> checked_map(WaveSettings::Mirror const&, LightOnMirror const&, double wavelength,
                                     std::vector<ArmProblem>&);
// Defects beside the mirror, or that scatter beyond the crossover angle.
struct MirrorInLight {
  double radius = 0, cosine = 1;         // m; of the angle of incidence
  double wavelength = 0, crossover = 0;  // m, rad
};
void check_defects(WaveSettings::Mirror const&, MirrorInLight const&, std::vector<ArmProblem>&);

double needed_memory(ArmCavity const&);  // bytes, of the fields

// Whether no light of the mode itself meets a rim: 2e-11 of it lies beyond.
bool clear_of_mode(ArmCavity const&, ArmRim const&);

constexpr int most_points = 8192;  // of a grid, along one side
// The next number of points that transforms are fast for, at most `most_points`; 0: none.
int allowed_points(int least);

}  // namespace straytrace::wave
