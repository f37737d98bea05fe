// SPDX-License-Identifier: BSD-3-Clause
// How light goes from patch to patch, by quadrature over pairs of points with visibility (docs/theory/sampling.md).
#pragma once

#include <vector>

#include "world/model/world.hpp"

namespace straytrace {

// Where light goes from one side of a patch, by sides.
struct Arriving {
  std::vector<float> share;
  std::vector<float> peak;  // mean square over mean of what the pairs of points say about the share
  bool empty() const { return share.empty(); }
};
struct Exchange {              // of one side of one patch
  Arriving diffuse, by_law;    // per unit of power that leaves, F; and of the beams that start here, by the true law
  std::vector<double> direct;  // score per unit of power arriving here, per goal
  double albedo = 0, emitted = 0;  // emitted: what `by_law` is a part of, about
};

// What receives: footprints of ports, then receivers, numbered as scores are.
std::vector<std::uint32_t> goals_of(WorldView const&);

// Of every side of every patch. Sides that scatter nothing have no lists, sides that no beam lights no `by_law`.
std::vector<Exchange> exchanges(World const&, SteeringTables const&, std::vector<std::uint32_t> const& goals,
                                unsigned samples, unsigned threads);

}  // namespace straytrace
