// SPDX-License-Identifier: BSD-3-Clause
// Case A25: with emitter and receiver swapped, every route run backwards couples alike (eq. 1.2 is symmetric).
#include "support/trace_support.hpp"

namespace straytrace::testing {
namespace {

enum class Law { lambertian, power_law, abg };

std::uint32_t optic_of(World& world, Law law) {
  if (law == Law::lambertian) return lambertian_optic(world, 0.4);
  if (law == Law::power_law) return power_law_optic(world, 0.05, 1.2, 0.1, 0.1);
  Optic optic;
  optic.laws = 1;
  optic.law[0] = world.add_law(abg(0.05, 0.3, 1.6));
  return world.add_optic(optic);
}

// A Gaussian spot at 20 degrees on a mirror, a uniform spot on a plate next to it, and a tilted disc above both.
SampleMean coupling(Law mirror, Law baffle, bool from_mirror, Vec3 mirror_spot = {0, 0.05, 0}) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world);
  SurfaceId const a =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.3}, optic_of(world, mirror), black, body, world.add_group("mirror"));
  SurfaceId const b = world.add_surface(Disk{{0.7, 0, 0.1}, unit({-0.2, 0, 1}), 0, 0.3},
                                        optic_of(world, Law::lambertian), black, body, world.add_group("plate"));
  world.add_surface(Disk{{0.4, 0.1, 1.2}, unit({0.1, 0.1, -1}), 0, 3}, optic_of(world, baffle), black, body,
                    world.add_group("baffle"));
  PortId const port = world.add_port("port");
  Vec3 const tilted = unit({std::sin(0.349), 0, -std::cos(0.349)});
  Footprint one = spot(a, mirror_spot, tilted, Profile::gaussian, 0.05, {}, 0);
  Footprint two = spot(b, {0.7, 0, 0.1}, {0.1, 0, -std::sqrt(0.99)}, Profile::even, 0.15, {}, 1);
  (from_mirror ? two : one).port = port;
  one.emits = two.receives = from_mirror;
  two.emits = one.receives = !from_mirror;
  world.add_footprint(one);
  world.add_footprint(two);
  world.limits.max_order = 2;
  world.finish();
  TraceResult const r = run_histories(world, 3 << 18);
  return route_coupling(r, from_mirror ? "mirror·S > baffle·S > plate·S" : "plate·S > baffle·S > mirror·S");
}

TEST(Reciprocity, SwapOfEmitterAndReceiverA25) {
  struct Case {
    Law mirror, baffle;
    double effect;
  };
  for (Case const c : {Case{Law::power_law, Law::lambertian, 3e-2}, {Law::lambertian, Law::power_law, 3e-2}}) {
    SampleMean const there = coupling(c.mirror, c.baffle, true), back = coupling(c.mirror, c.baffle, false);
    expect_mean("A25", difference(there, back), 0, c.effect * there.mean);
  }
  SampleMean const there = coupling(Law::abg, Law::abg, true), back = coupling(Law::abg, Law::abg, false);
  expect_mean("A25", difference(there, back), 0, 3e-2 * there.mean);
  // control: the emitting spot is 10 cm off the receiving one
  expect_rejected("moved spot", difference(coupling(Law::abg, Law::abg, true, {-0.1, 0.05, 0}), back), 0);
}

}  // namespace
}  // namespace straytrace::testing
