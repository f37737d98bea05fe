// SPDX-License-Identifier: BSD-3-Clause
// The tables that steer the walk: adjoint of every side of every patch, and the patches worth aiming at from there
// (docs/theory/sampling.md). A function of the scene only.
#pragma once

#include "trace/steered_world.hpp"

namespace straytrace::trace {

struct ImportanceSettings {
  double alpha = 0.25;                      // least share of directions drawn from the BSDF model; at least 0.1
  bool window = true;                       // weight window: split and end paths by power x adjoint
  unsigned samples = 8;                     // lines per pair of patches
  double decisive = 1.0 / 256;              // share of the effort from which all lines of a pair are traced
  double unseen = 0.1;                      // of a pair whose one traced line is hidden: what its light counts for
  std::size_t most_patches = 1000;          // with more strips neighbours are joined; the work grows with the square
  std::uint64_t pilot_histories = 1 << 14;  // 0: no pilot
  std::size_t most_targets = 128;           // per side of a patch that no beam lights
  unsigned threads = 0;                     // 0: all cores; does not affect the tables
};

// Light leaving patch i, its arrival on each side of patch j, and its expected score: the linear system
//   A_i = D_i + albedo_i sum_j F_ij A_j
// with F the diffuse exchange by quadrature over pairs of points with visibility, and D the connections to all goals.
// Emitting patches choose their targets with their true BSDF. Each goal counts in units of its own total, so that faint
// ports are sampled too. A pilot run raises the adjoints of light that reaches goals through mirrors or glass.
SteeringTables make_importance(World const&, ImportanceSettings const& = {});

// Prepares a world for tracing within its limits: receivers behind glass, adjoint tables, targets, cells of maps. The
// pilot runs only for receivers, which mirrors and glass may feed.
SteeredWorld steer(World&, unsigned threads = 0);

// Gives sub-paths to receivers (trace/step/sub_path.hpp), and marks those that see part of the scene through lenses or
// mirrors.
void find_covered_receivers(World&);
// Gives sub-paths to the modes for which they pay, by a short separate run.
void choose_sub_paths_of_modes(World&);
// Chooses how often those of receivers aim at each mirror or glass, by a short separate run.
void choose_aim_shares(World&);
// Lessens those of receivers where that lessens error and cost, by a short separate run. Histories of these runs never
// enter results.
void choose_sub_paths_of_receivers(World&);

// Only the strips, each its own patch.
SteeringTables make_strips(World const&);
// Bounds of a strip; parts of surfaces by twenty of their points.
Box bounds_of(WorldView const&, Strip const&);

}  // namespace straytrace::trace
