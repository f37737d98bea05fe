// SPDX-License-Identifier: BSD-3-Clause
// A tube that has all kinds of events, and worlds of plates that cost next to nothing.
#pragma once

#include "support/trace_support.hpp"

namespace straytrace::testing {

// Baffled tube with a cavity's two spots: specular, diffuse and power-law events, several routes.
inline World small_tube() {
  World world;
  BodyId const mirrors = world.add_body("mirrors", {}), pipe = world.add_body("pipe", {});
  std::uint32_t const mirror = power_law_optic(world, 1e-3, 1.8, 1e-3, 0.3), black = black_optic(world),
                      grey = lambertian_optic(world, 0.4);
  SurfaceId const one = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.3}, mirror, black, mirrors, world.add_group("one"));
  SurfaceId const two =
      world.add_surface(Disk{{0, 0, 20}, {0, 0, -1}, 0, 0.3}, mirror, black, mirrors, world.add_group("two"));
  world.add_surface(Cylinder{{}, {0, 0, 1}, 0.6, 0, 20}, black, grey, pipe, world.add_group("wall"));
  for (int i = 1; i < 20; ++i)
    world.add_surface(Disk{{0, 0, double(i)}, {0, 0, 1}, 0.4, 0.6}, grey, grey, pipe, world.add_group("baffles"));
  world.add_footprint(spot(one, {}, {0, 0, -1}, Profile::gaussian, 0.05, world.add_port("one")));
  world.add_footprint(spot(two, {0, 0, 20}, {0, 0, 1}, Profile::even, 0.1, world.add_port("two")));
  world.limits.max_order = 10;
  world.finish();
  return world;
}

inline World one_plate() {
  World world;
  SurfaceId const s = world.add_surface(Disk{}, lambertian_optic(world, 0.5), black_optic(world),
                                        world.add_body("plate", {}), world.add_group("plate"));
  world.add_footprint(spot(s, {}, {0, 0, -1}, Profile::gaussian, 0.1, world.add_port("plate")));
  world.finish();
  return world;
}

// Some routes, the longer ones so rare that not every block scores in them.
inline World two_plates() {
  World world;
  BodyId const body = world.add_body("plates", {});
  std::uint32_t const grey = lambertian_optic(world, 0.3), black = black_optic(world);
  SurfaceId const one = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, grey, black, body, world.add_group("one"));
  world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 0.1}, grey, black, body, world.add_group("two"));
  world.add_footprint(spot(one, {}, {0, 0, -1}, Profile::gaussian, 0.01, world.add_port("one")));
  world.limits.max_order = 4;
  world.finish();
  return world;
}

}  // namespace straytrace::testing
