// SPDX-License-Identifier: BSD-3-Clause
// Closed Lambertian enclosures (docs/theory/sampling.md; cases A18, A18b): arriving power 1/(1 - rho), share of
// order n rho^(n-1), uniform radiance without absorption, the integrating sphere.
#include "support/trace_support.hpp"

namespace straytrace::testing::trace_furnace {
namespace {

constexpr double cut = 0.8;  // rim radius at which each hemisphere of the unit sphere is cut in two

// Unit sphere about the origin; the lit hemisphere looks up. `hole`: rim radius of a black port at the far pole.
World sphere(double rho, Profile profile, double radius, double hole = 0, bool one_group = true) {
  World world;
  BodyId const body = world.add_body("sphere", {});
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  Cap const low{{0, 0, -1}, {0, 0, 1}, 1, 0, cut}, high{{0, 0, 1}, {0, 0, -1}, 1, 0, cut};
  auto const ring = [](Cap c, double from, double to) {
    c.inner_radius = from;
    c.outer_radius = to;
    return c;
  };
  auto const group = [&](char const* name) { return world.add_group(one_group ? "wall" : name); };
  SurfaceId const lit = world.add_surface(low, white, black, body, group("lit"));
  world.add_surface(ring(low, cut, 1), white, black, body, group("lit rim"));
  world.add_surface(ring(high, hole, cut), white, black, body, group("far"));
  world.add_surface(ring(high, cut, 1), white, black, body, group("far rim"));
  if (hole > 0) world.add_surface(ring(high, 0, hole), black, black, body, world.add_group("port"));
  world.add_footprint(spot(lit, {0, 0, -1}, {0, 0, -1}, profile, radius));
  world.limits.max_order = 2000;
  world.finish();
  return world;
}
// Closed cylinder, radius 1, from z = 0 to h; the lower disc is lit.
World can(double rho, double h, bool one_group = true) {
  World world;
  BodyId const body = world.add_body("can", {});
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  auto const group = [&](char const* name) { return world.add_group(one_group ? "wall" : name); };
  SurfaceId const floor = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, white, black, body, group("floor"));
  world.add_surface(Disk{{0, 0, h}, {0, 0, -1}, 0, 1}, white, black, body, group("lid"));
  world.add_surface(Cylinder{{}, {0, 0, 1}, 1, 0, h}, black, white, body, group("wall"));
  world.add_footprint(spot(floor, {0.2, 0, 0}, {0, 0, -1}, Profile::gaussian, 0.2));
  world.limits.max_order = 2000;
  world.finish();
  return world;
}

TEST(Furnace, ClosedSphereArrivingPower) {
  struct Case {
    double rho;
    Profile profile;
    double radius;
  };
  for (Case const c : {Case{0.9, Profile::even, 0.3}, {0.9, Profile::point, 0}, {0.5, Profile::gaussian, 0.1}}) {
    World world = sphere(c.rho, c.profile, c.radius);
    TraceResult const r = run_histories(world, 1 << 17);
    double const expected = 1 / (1 - c.rho);
    SampleMean const s = arrived(world, r, "wall");
    expect_mean("sphere", s, expected, 2e-3 * expected);
    expect_rejected("a wall that is 0.1 % more reflecting", s, 1 / (1 - 1.001 * c.rho));
    EXPECT_LT(r.total.energy_balance[int(BalanceTerm::escaped)].sum, 1e-6 * r.total.emitted.sum);
  }
}

TEST(Furnace, ClosedCylinderArrivingPower) {
  World world = can(0.9, 3);
  TraceResult const r = run_histories(world, 1 << 17);
  SampleMean const s = arrived(world, r, "wall");
  expect_mean("can", s, 10, 2e-2);
  expect_rejected("a wall that is 0.1 % more reflecting", s, 1 / (1 - 0.9009));
}

// Power arriving at each order, and whether roulette divides by its probability.
struct Orders : Silent {
  std::vector<double> power = std::vector<double>(60);
  double emitted_power = 0, window = 0;
  void emitted(PathState const& path, Vertex const&) { emitted_power += path.emitted; }
  void visit(PathState const& path, Vertex const&) {
    if (path.event <= power.size()) power[path.event - 1] += path.power;
  }
  void book(BalanceTerm balance_term, double p) {
    if (balance_term == BalanceTerm::roulette) window += p;
  }
};

// Share of order n: rho^(n-1). Without roulette it is exact; with it, on average.
TEST(Furnace, ShareOfEachOrder) {
  double const rho = 0.7;
  World world = sphere(rho, Profile::even, 0.3);
  world.limits.roulette_below = 0;
  Orders exact;
  walk(world, 200, exact, [] {});
  for (std::size_t n = 1; n <= 40; ++n) {
    double const expected = std::pow(rho, double(n - 1));
    EXPECT_NEAR(exact.power[n - 1] / exact.emitted_power, expected, 1e-12 * expected);
  }
  world.limits.roulette_below = 0.1;
  Sampler order12;
  double before = 0;
  Orders chance;
  walk(world, 1 << 18, chance, [&] {
    order12.add((chance.power[11] - before) / rho);
    before = chance.power[11];
  });
  double const expected = std::pow(rho, 11);
  expect_mean("order 12 through roulette", order12.mean(), expected, 3e-2 * expected);
  EXPECT_NE(chance.window, 0);
}

// The walk of step.hpp with a roulette that forgets to divide by its probability: the same check must see it.
double arriving(World const& world, bool divide) {
  WorldView const view = world.view();
  double sum = 0, emitted_power = 0;
  Silent sink;
  for (std::uint64_t h = 0; h < 20000; ++h) {
    PathState path;
    path.history = h;
    if (!emit(view, 1, path, sink)) continue;
    emitted_power += path.emitted;
    for (bool alive = true; alive;) {
      Hit const hit = view.closest(path.ray, path.from);
      Vertex v = make_vertex(view, hit.surface, path.ray.origin + hit.distance * path.ray.dir, path.ray.dir);
      evaluate_scattering(view, path, path.ray.dir, v);
      path.power *= finish_hop_weight(view, path, &v);
      ++path.event;
      sum += path.power;
      double const before = path.power;
      alive = control(view, 1, path, v, 0, sink) > 0;
      if (alive && !divide) path.power = before;
      alive = alive && scatter(view, 1, path, v, sink);
    }
  }
  return sum / emitted_power;
}
TEST(Furnace, RouletteWithoutItsDivision) {
  World const world = sphere(0.9, Profile::even, 0.3);
  EXPECT_NEAR(arriving(world, true), 10, 0.1);
  EXPECT_LT(arriving(world, false), 9.5);
}

// R3.27: a cut that is 10 times lower moves the result by no more than its error. Without the division it does.
TEST(Furnace, LowerCutR3_27) {
  World high = sphere(0.9, Profile::even, 0.3), low = sphere(0.9, Profile::even, 0.3);
  high.limits.roulette_below = 0.3;
  low.limits.roulette_below = 0.03;
  TraceResult const a = run_histories(high, 1 << 17, 1), b = run_histories(low, 1 << 17, 2);
  expect_mean("cut 0.3 against 0.03", difference(arrived(high, a, "wall"), arrived(low, b, "wall")), 0, 0.1);
  for (TraceResult const* r : {&a, &b}) {  // watts cut are reported, and cancel on average
    Estimate const watts =
        estimate(r->total.energy_balance[int(BalanceTerm::roulette)], r->total.histories, r->total.blocks);
    EXPECT_GT(watts.std_error, 0);
    EXPECT_LT(std::fabs(watts.mean), 5 * watts.std_error);
  }
  EXPECT_GT(std::fabs(arriving(high, false) - arriving(low, false)), 0.1);  // negative control
}

// A18b: rho = 1 everywhere. All light is still there after N bounces.
TEST(Furnace, NothingIsLostA18b) {
  World world = sphere(1, Profile::even, 0.3);
  world.limits.max_order = 300;
  TraceResult const r = run_histories(world, 4096);
  EXPECT_NEAR(r.total.energy_balance[int(BalanceTerm::truncated)].sum, r.total.emitted.sum,
              1e-12 * r.total.emitted.sum);
  EXPECT_EQ(r.total.bounces, 4096u * 300u);
  World leaky = sphere(1 - 1e-9, Profile::even, 0.3);  // control: one part in 1e9 is absorbed
  leaky.limits.max_order = 300;
  TraceResult const t = run_histories(leaky, 4096);
  EXPECT_GT(std::fabs(t.total.energy_balance[int(BalanceTerm::truncated)].sum - t.total.emitted.sum),
            1e-12 * t.total.emitted.sum);
}

// Share of all arrivals of a history, from order `first` on, that falls on each group.
struct Shares : Silent {
  std::uint32_t first;
  std::vector<Sampler> share;
  std::vector<double> now;
  WorldView view;
  Shares(World const& world, std::uint32_t from)
      : first(from), share(world.groups().size()), now(share.size()), view(world.view()) {}
  void visit(PathState const& path, Vertex const& v) {
    if (path.event >= first) now[view.surfaces[v.surface.value].group.value] += path.power;
  }
  void close() {
    double all = 0;
    for (double const p : now) all += p;
    for (std::size_t g = 0; g < now.size(); ++g) share[g].add(now[g] / all);
    now.assign(now.size(), 0);
  }
};

// A18b: uniform radiance. In a sphere every bounce is uniform; in a can, after it has forgotten its source.
TEST(Furnace, UniformRadianceA18b) {
  World ball = sphere(1, Profile::even, 0.3, 0, false), tin = can(1, 3, false);
  ball.limits.max_order = 20;
  tin.limits.max_order = 140;
  Shares on_ball(ball, 1), on_tin(tin, 41);
  walk(ball, 40000, on_ball, [&] { on_ball.close(); });
  walk(tin, 10000, on_tin, [&] { on_tin.close(); });
  double const inner = (1 - 0.6) / 2, rim = 0.6 / 2;  // zones by height: rim radius 0.8 is 0.4 above the pole
  expect_mean("lit", on_ball.share[0].mean(), inner, 5e-3);
  expect_mean("lit rim", on_ball.share[1].mean(), rim, 5e-3);
  expect_mean("far", on_ball.share[2].mean(), inner, 5e-3);
  expect_mean("far rim", on_ball.share[3].mean(), rim, 5e-3);
  expect_mean("floor", on_tin.share[0].mean(), 1.0 / 8, 5e-3);
  expect_mean("lid", on_tin.share[1].mean(), 1.0 / 8, 5e-3);
  expect_mean("wall", on_tin.share[2].mean(), 6.0 / 8, 5e-3);
  expect_rejected("parts weighted by cross-section", on_ball.share[0].mean(), 0.64 / 2);
  Shares early(tin, 1);  // control: a can that still remembers its source
  tin.limits.max_order = 3;
  walk(tin, 10000, early, [&] { early.close(); });
  expect_rejected("first orders", early.share[0].mean(), 1.0 / 8);
}

// A18: port flux per flux first hitting the wall, rho f/(1 - rho (1 - f)) = 0.2753623 for rho 0.95, f 0.02.
TEST(Furnace, IntegratingSphereA18) {
  double const rho = 0.95, f = 0.02, depth = 2 * f;  // area share of a cap of a sphere: depth/diameter
  World world = sphere(rho, Profile::even, 0.3, std::sqrt(2 * depth - depth * depth));
  TraceResult const r = run_histories(world, 1 << 18);
  SampleMean const s = scaled(arrived(world, r, "port"), rho);
  expect_mean("port", s, 0.2753623, 7e-3);
  expect_rejected("first bounce counted as an order", s, 0.2753623 / rho);
  expect_rejected("multiplier without the port", s, rho * f / (1 - rho));
}

}  // namespace
}  // namespace straytrace::testing::trace_furnace
