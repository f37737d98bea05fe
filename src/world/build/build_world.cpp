// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "scene/library.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace {

void read_trace_limits(Scene const& scene, World& world) {
  Node const t = scene.table("trace");
  if (!t) return;
  world.limits.max_order = std::uint32_t(t.whole("order_limit", world.limits.max_order, 1, 1e6));
  world.limits.roulette_below = t.number("roulette_below", dim::plain, world.limits.roulette_below, 0, 1);
  world.limits.route_vertices = std::uint32_t(t.whole("route_vertices", world.limits.route_vertices, 2, 8));
  world.limits.targets = t.flag("targets", true);
  world.limits.law_share = t.number("law_share", dim::plain, world.limits.law_share, 0.1, 1);
  world.limits.window = t.flag("window", true);
  world.limits.children = std::uint32_t(t.whole("children", world.limits.children, 1, 100000));
  world.reverse_routes = t.flag("reverse_routes", true);
  static constexpr std::string_view structures[] = {"axial", "none"};
  world.limits.brute_force = t.choice("structure", structures, "axial") == "none";
}

World build_world(Scene const& scene) {
  World world;
  Registry names;
  world.notes = assumed_parameters(scene);
  read_media(scene, world, names);
  read_materials(scene, world, names);
  read_bodies(scene, world, names);
  read_surfaces(scene, world, names);
  world.settle_pivots();
  read_receivers(scene, world, names);
  read_beams(scene, world, names);
  read_edges(scene, world);
  read_trace_limits(scene, world);
  if (scene.root().healthy()) {  // shapes with missing numbers cannot be searched
    world.finish();
    check_lays(scene, world);
    check_glass(scene, world, names);
    check_beams(scene, world);
    check_faces(scene, world);
  }
  return world;
}

}  // namespace straytrace
