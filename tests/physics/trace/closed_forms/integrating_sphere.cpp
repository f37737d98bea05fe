// SPDX-License-Identifier: BSD-3-Clause
// Integrating sphere with receivers (docs/theory/sampling.md): multiplier M = rho/(1 - rho (1 - f)) of a sphere with
// a black port of area share f, and the exchange of any two patches of the wall, A/(4 pi R^2).
#include "support/shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing {
namespace {

// Area share of a cap of the unit sphere of this rim radius, and the reverse.
double share_of(double rim) { return 0.5 * (1 - std::sqrt(1 - rim * rim)); }
double rim_of(double share) { return 2 * std::sqrt(share * (1 - share)); }

// A beam lights a spot of the lower half; the port is at the upper pole. Received: f M.
SampleMean multiplier(double rho, double f, std::uint64_t histories) {
  World world;
  BodyId const body = world.add_body("sphere", {});
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  GroupId const wall = world.add_group("wall");
  SurfaceId const low = world.add_surface(cap(1, 0, 1, {{0, 0, -1}, {0, 0, 1}}), white, black, body, wall);
  Placement const top{{0, 0, 1}, {0, 0, -1}};
  world.add_surface(cap(1, rim_of(f), 1, top), white, black, body, wall);
  receive_on(world, "port", world.add_surface(cap(1, 0, rim_of(f), top), black, black, body, world.add_group("port")));
  world.add_footprint(spot(low, {0, 0, -1}, {0, 0, -1}, Profile::even, 0.3));
  world.limits.max_order = 4000;
  world.limits.roulette_below = 0.5;
  world.finish();  // the BSDF model alone: aiming has nothing to give where every part sees every other alike
  return scaled(received(run_histories(world, histories)), 1 / f);
}

// Controls: the multiplier of a closed sphere, and that of one with a larger port.
TEST(IntegratingSphere, MultiplierScene2) {
  struct Case {
    double rho, f, expected;
    std::uint64_t histories;
  };
  for (Case const c : {Case{0.98, 0.05, 14.2029, 1 << 16}, {0.99, 0.01, 49.7487, 1 << 15}}) {
    EXPECT_NEAR(c.rho / (1 - c.rho * (1 - c.f)), c.expected, 1e-5 * c.expected);
    SampleMean const m = multiplier(c.rho, c.f, c.histories);
    expect_mean("multiplier", m, c.expected, 3e-2 * c.expected);
    expect_rejected("no port", m, c.rho / (1 - c.rho));
    expect_rejected("a port twice as large", m, c.rho / (1 - c.rho * (1 - 2 * c.f)));
  }
}

// Patches of different sizes near the lit one, adjacent and opposite. Control: a patch 5 % off the sphere.
TEST(IntegratingSphere, ExchangeOfPatchesScene2) {
  auto const exchange = [](Vec3 at, double rim, double off, std::uint64_t histories) {
    World world;
    BodyId const body = world.add_body("all", {});
    std::uint32_t const white = lambertian_optic(world, 0.8), black = black_optic(world);
    SurfaceId const lit =
        world.add_surface(cap(1, 0, 0.3, {{0, 0, -1}, {0, 0, 1}}), white, black, body, world.add_group("lit"));
    receive_on(world, "patch",
               world.add_surface(cap(1, 0, rim, {(1 + off) * at, -at}), black, black, body, world.add_group("patch")));
    world.add_footprint(spot(lit, {0, 0, -1}, {0, 0, -1}, Profile::even, 0.25));
    world.limits.max_order = 1;
    prepare(world);
    return received_share(run_histories(world, histories));
  };
  struct Case {
    Vec3 at;
    double rim;
  };
  for (Case const c : {Case{{0, 0, 1}, 0.2}, {unit({1, 0, -0.6}), 0.3}, {unit({0.3, -1, 0.4}), 0.05}}) {
    SampleMean const s = exchange(c.at, c.rim, 0, 1 << 18);
    expect_mean("A/(4 pi R^2)", s, share_of(c.rim), 1.5e-3 * share_of(c.rim));
    expect_rejected("flat area over 4 pi R^2", s, 0.25 * c.rim * c.rim);
    expect_rejected("off the sphere", exchange(c.at, c.rim, 0.05, 1 << 16), share_of(c.rim));
  }
}

}  // namespace
}  // namespace straytrace::testing
