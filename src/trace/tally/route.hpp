// SPDX-License-Identifier: BSD-3-Clause
// The route of a score: how many vertices it has, and its hash.
#pragma once

#include "trace/estimate/connect.hpp"

namespace straytrace {

struct Route {
  std::uint64_t hash = 0;
  std::uint32_t vertices = 0;
  bool other = false;  // longer than the limit: summed in one class per port and source beam
};

inline Route route_of(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t lit,
                      std::uint32_t connection) {
  Footprint const& end = world.lit[lit];
  std::uint64_t name = path.route;
  Route route;
  route.vertices = path.order + 1;
  if (!by_itself(connection)) {
    name = extended(name, world.surfaces[vertex.surface.value].group, Event::scatter);
    ++route.vertices;
  }
  route.other = route.vertices > world.limits.route_vertices;
  name = route.other ? 0 : extended(name, world.surfaces[end.surface.value].group, Event::couple);
  // C_rev depends on the beams at the two ends, so paths of different source beams are never one class.
  std::uint64_t const beam = std::uint64_t(world.lit[path.source].beam) + 1;
  route.hash = mixed(mixed(name + beam) + (std::uint64_t(end.port.value) + 1) * 0xd1342543de82ef95ull);
  return route;
}

}  // namespace straytrace
