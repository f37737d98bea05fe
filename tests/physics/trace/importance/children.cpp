// SPDX-License-Identifier: BSD-3-Clause
// Children at a hit (C2.1): N paths that share the power, whatever N; and a walk that splits and
// ends paths by chance keeps its energy balance (docs/theory/sampling.md).
#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing {
namespace {

// A white sphere from inside, with a lit plate and a small black photodiode in it.
World white_sphere(std::uint32_t children) {
  World world;
  BodyId const body = world.add_body("sphere", {});
  std::uint32_t const white = lambertian_optic(world, 0.7), black = black_optic(world);
  world.add_surface(Sphere{{}, {0, 0, 1}, 1}, black, white, body, world.add_group("wall"));
  SurfaceId const lamp =
      world.add_surface(Disk{{0, 0, -0.5}, {0, 0, 1}, 0, 0.2}, white, white, body, world.add_group("lamp"));
  SurfaceId const chip = world.add_surface(Disk{{0.2, 0.1, 0.3}, unit({1, 2, 3}), 0, 0.05}, black, black, body,
                                           world.add_group("photodiode"));
  world.add_footprint(spot(lamp, {0, 0, -0.5}, {0, 0, -1}, Profile::even, 0.2));
  Receiver r;
  r.surface = chip;
  world.add_receiver("photodiode", r);
  world.limits.children = children;
  world.limits.route_vertices = 8;
  world.finish();
  return world;
}

// Power on the way from the first surface to the second, over that which arrived on the first.
struct Generations : Silent {
  double first = 0, second = 0, booked = 0, emitted_power = 0;
  int children = 0;
  void emitted(PathState const& path, Vertex const&) { emitted_power = path.emitted; }
  void visit(PathState const& path, Vertex const& vertex) {
    if (path.order == 1) first = path.power * vertex.albedo;
    if (path.order != 2) return;
    second += path.power;
    ++children;
  }
  void book(BalanceTerm, double power) { booked += power; }
};

TEST(Children, ShareThePowerOfTheirParentR3_26) {
  for (std::uint32_t const n : {1u, 10u, 1000u}) {
    World world = white_sphere(n);
    world.limits.max_order = 2;
    world.limits.roulette_below = 0;
    Generations g;
    walk(world, 20, g, [&] {
      if (g.first > 0) {
        EXPECT_EQ(g.children, int(n));
        EXPECT_NEAR(g.second / g.first, 1, 1e-12);
        EXPECT_TRUE(n == 1 || std::fabs(g.second / n / g.first - 1) > 0.8);  // control: amplitude sqrt(S)/N, C2.1
      }
      EXPECT_NEAR(g.booked / g.emitted_power, 1, 1e-12);
      g = {};
    });
  }
}

SampleMean watts(std::uint32_t children, std::uint64_t histories) {
  TraceResult const r = run_histories(white_sphere(children), histories);
  Estimate const e = r.coupling.received_power[0];
  return {e.mean, e.std_error, (long long)histories};
}

TEST(Children, ChangeTheErrorNotTheMean) {
  SampleMean const one = watts(1, 1 << 18), ten = watts(10, 1 << 15);
  expect_mean("ten children", difference(ten, one), 0, 0.04 * one.mean);
  expect_rejected("power of one child more", difference(scaled(ten, 1.1), one), 0);
}

// Behind a small stop nearly all that is worth something wins rarely: such a trace must not be called wrong, and one
// that does not divide by the survival probability must.
World rarely_lucky() {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.999), grey = lambertian_optic(world, 0.3),
                      black = black_optic(world);
  SurfaceId const lamp = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.01}, white, black, body, world.add_group("lamp"));
  GroupId const plates = world.add_group("plates");
  for (int i = 0; i < 100; ++i)
    world.add_surface(Disk{{0.03 * i, 0, 1}, {0, 0, -1}, 0, 0.01}, grey, black, body, plates);
  SurfaceId const chip =
      world.add_surface(Disk{{0.3, 0, 0}, {0, 0, 1}, 0, 1e-3}, black, black, body, world.add_group("photodiode"));
  world.add_footprint(spot(lamp, {}, {0, 0, -1}, Profile::even, 0.01));
  Receiver r;
  r.surface = chip;
  world.add_receiver("photodiode", r);
  world.finish();
  steer(world);
  return world;
}

TEST(Window, RareSurvivalsAreNotAnError) {
  World const world = rarely_lucky();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) EXPECT_NO_THROW(run_histories(world, 48 * largest_block, seed));
}

// The spread of the drawn weights alone would reject some of them; the survival probabilities prevent this.
TEST(Window, WithoutTheProbabilitiesSomeAreRejected) {
  World const world = rarely_lucky();
  int rejected = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TraceResult const r = run_histories(world, 48 * largest_block, seed);
    Estimate const e = estimate(r.total.energy_balance[int(BalanceTerm::roulette)], r.total.histories, r.total.blocks);
    rejected += std::fabs(e.mean) > 5 * e.std_error;
    EXPECT_LT(std::fabs(e.mean),
              5 * std::max(e.std_error, std::sqrt(r.total.window_variance) / double(r.total.histories)));
  }
  EXPECT_GT(rejected, 0);
}

}  // namespace
}  // namespace straytrace::testing
