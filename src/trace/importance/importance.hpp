// SPDX-License-Identifier: BSD-3-Clause
// The tables that steer the walk: adjoint of every side of every patch, and the patches worth aiming at from there
// (docs/theory/sampling.md). A function of the scene only.
#pragma once

#include <string>

#include "world/model/world.hpp"

namespace straytrace {

struct ImportanceSettings {
  double alpha = 0.25;                      // share of directions that the scatter law keeps; never below 0.1
  bool window = true;                       // split and weed paths by power x adjoint
  unsigned samples = 8;                     // pairs of points per pair of patches
  std::size_t most_strips = 2500;           // each a patch of its own; with more neighbours are joined
  std::size_t most_patches = 1000;          // then; the work grows with the square
  std::uint64_t pilot_histories = 1 << 14;  // 0: no pilot
  std::size_t most_targets = 128;           // per side of a patch that no beam lights
  unsigned threads = 0;                     // 0: all cores; no matter to the tables
};

// How much of the light that leaves patch i arrives on each side of patch j, and what it will score: the linear system
//   A_i = D_i + albedo_i sum_j F_ij A_j
// with F the diffuse exchange by quadrature over pairs of points with visibility, D the connections to everything that
// receives. Emitting patches choose their targets with their true scatter law. Each port counts in units of its own
// total, so that faint ports get effort too. A pilot run raises adjoints of what leads there by mirrors or glass.
SteeringTables make_importance(World const&, ImportanceSettings const& = {});

// Everything that steers a trace of this scene, as its limits ask: receivers behind glass, adjoint tables, targets,
// cells of maps. The pilot is for receivers, which mirrors and glass may feed.
void steer(World&, unsigned threads = 0);

// Marks the receivers that see part of the scene through lenses or mirrors (trace/step/specular_connection.hpp).
void find_covered_receivers(World&);

// The strips alone, each a patch of its own.
SteeringTables make_strips(World const&);
// About a strip: parts of surfaces by twenty of their points.
Box bounds_of(WorldView const&, Strip const&);

}  // namespace straytrace
