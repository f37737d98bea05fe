// SPDX-License-Identifier: BSD-3-Clause
// Targets written by hand for the first hop of small worlds: strips of walls that the BSDF model alone seldom meets.
#pragma once

#include <vector>

#include "support/trace_support.hpp"

namespace straytrace::testing {

struct AimedWall {
  SurfaceId surface;
  double area;                // m^2
  std::vector<double> edges;  // ascending first sample coordinates (geometry/strips.hpp) of its strips, 0 and 1 at ends
  std::size_t first = 0, last = ~std::size_t{0};  // strips that are targets: [first, last)
};

// Light scattered by `from` takes the law with the share `alpha`, and all targets equally often otherwise. Later hops
// take the law.
inline SteeringTables aimed_walls(World const& world, SurfaceId from, std::vector<AimedWall> const& walls,
                                  double alpha = 0.25) {
  SteeringTables t;
  std::uint32_t from_patch = 0;
  std::vector<std::uint32_t> aims;
  for (std::uint32_t i = 0; i < world.surfaces().size(); ++i) {
    AimedWall whole{{i}, 1, {0, 1}, 0, 0};
    for (AimedWall const& w : walls)
      if (w.surface == SurfaceId{i}) whole = w;
    t.first_of_surface.push_back(std::uint32_t(t.strips.size()));
    if (from == SurfaceId{i}) from_patch = std::uint32_t(t.patches.size());
    for (std::size_t k = 0; k + 1 < whole.edges.size(); ++k) {
      auto const number = std::uint32_t(t.strips.size());
      double const low = whole.edges[k], high = whole.edges[k + 1];
      t.strips.push_back({{i}, low, high, (high - low) * whole.area, number});
      t.patches.push_back({t.strips.back().area, number, 1});
      t.members.push_back({number, 0});
      if (whole.first <= k && k < whole.last) aims.push_back(number);
    }
  }
  t.first_of_surface.push_back(std::uint32_t(t.strips.size()));
  for (std::size_t k = 0; k < aims.size(); ++k)
    t.targets.push_back({aims[k], 1.0 / double(aims.size()), double(k + 1) / double(aims.size())});
  t.sides.assign(2 * t.patches.size(), {1, 1, 0, 0});
  for (std::uint32_t side : {2 * from_patch, 2 * from_patch + 1})
    t.sides[side] = {1, alpha, 0, std::uint32_t(aims.size())};
  return t;
}

}  // namespace straytrace::testing
