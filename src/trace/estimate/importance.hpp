// SPDX-License-Identifier: BSD-3-Clause
// The tables that steer the walk: adjoint of every side of every strip, and the strips worth aiming at from there
// (estimators.md 6 to 8). A function of the scene only.
#pragma once

#include <string>

#include "world/world.hpp"

namespace straytrace {

struct ImportanceSettings {
  double alpha = 0.25;                      // share of directions that the scatter law keeps; never below 0.1
  bool window = true;                       // split and weed paths by power x adjoint
  unsigned samples = 8;                     // pairs of points per pair of strips
  std::size_t most_strips = 2500;           // above: no steering, the scatter law alone
  std::uint64_t pilot_histories = 1 << 14;  // 0: no pilot
  std::size_t most_targets = 128;           // per side of a strip that no beam lights
};

// How much of the light that leaves strip i arrives on each side of strip j, and what it will score: the linear system
//   A_i = D_i + albedo_i sum_j F_ij A_j
// with F the diffuse exchange by quadrature over pairs of points with visibility, D the connections to everything that
// receives. Emitting strips choose their targets with their true scatter law. Each port counts in units of its own
// total, so that faint ports get effort too. A pilot run raises adjoints of what leads there by mirrors or glass.
SteeringTables make_importance(World const&, ImportanceSettings const& = {});

// Everything that steers a trace of this scene, as its limits ask: receivers behind glass, adjoint tables, targets. The
// pilot is for receivers, which mirrors and glass may feed. Says in words what could not be made; empty: all was.
std::string steer(World&);

// Marks the receivers that see part of the scene through lenses or mirrors (trace/estimate/through_glass.hpp).
void find_covered_receivers(World&);

// The strips alone: what tables of importance are written about.
SteeringTables make_strips(World const&);

}  // namespace straytrace
