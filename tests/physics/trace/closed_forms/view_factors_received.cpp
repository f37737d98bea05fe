// SPDX-License-Identifier: BSD-3-Clause
// View factors by receivers, standard errors of 3e-4 to 6e-4, the rare ones far better (docs/theory/sampling.md and
// 4): an evenly lit Lambertian surface and what arrives on another, counted in watts by walk and connections together.
#include "support/shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_view_factors_received {
namespace {

// Coaxial discs, r1 -> r2 at distance h, without cancellation.
double coaxial(double r1, double r2, double h) {
  double const a = h * h + r1 * r1 + r2 * r2, root = std::sqrt(a * a - 4 * r1 * r1 * r2 * r2);
  return 2 * r2 * r2 / (a + root);
}

SampleMean disc_to_disc(double near, double hole, double far, double distance, std::uint64_t histories) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  SurfaceId const low = world.add_surface(disk(0, near), white, black, body, world.add_group("near"));
  receive_on(
      world, "far",
      world.add_surface(disk(hole, far, {{0, 0, distance}, {0, 0, -1}}), black, black, body, world.add_group("far")));
  world.add_footprint(spot(low, {}, {0, 0, -1}, Profile::even, near));
  world.limits.max_order = 1;
  prepare(world);
  return received_share(run_histories(world, histories));
}

TEST(ViewFactorsReceived, CoaxialDiscsScene3) {
  SampleMean const s = disc_to_disc(1, 0, 1, 1, 1 << 21);
  expect_mean("discs", s, 0.381966, 3.6e-3 * 0.381966);
  expect_rejected("0.5 % further apart", s, coaxial(1, 1, 1.005));
}

// Rays from a disc to another 4 or 10 km away are worth the same to 1e-8; those to the ring differ by 0.4 %.
TEST(ViewFactorsReceived, RareOnesScene4) {
  struct Case {
    double near, hole, far, distance, expected, digits, effect;
  };
  for (Case const c : {Case{0.17, 0, 0.17, 3994.5, 1.811227e-9, 5e-16, 1e-7},
                       {0.31, 0, 0.31, 1e4, 9.6100e-10, 5e-15, 1e-7},
                       {0.17, 0.5, 0.6, 100, 1.09993e-5, 5e-11, 5e-5}}) {
    auto const closed = [&](double factor) {
      return coaxial(c.near, c.far, factor * c.distance) -
             (c.hole > 0 ? coaxial(c.near, c.hole, factor * c.distance) : 0);
    };
    EXPECT_NEAR(closed(1), c.expected, c.digits);
    double const seen = disc_to_disc(c.near, c.hole, c.far, c.distance, 1 << 17).mean;
    EXPECT_NEAR(seen, closed(1), c.effect * closed(1));
    EXPECT_GT(std::fabs(seen - closed(1 + c.effect)), c.effect * closed(1));  // control: further away by that
  }
}

// Light scattered by one history, and its part that arrived on each receiver.
struct Arrivals : Silent {
  explicit Arrivals(World const& world) : first(std::uint32_t(world.footprints().size())) {}
  void emitted(PathState const& path, Vertex const&) { scattered = path.emitted; }
  void score(PathState const&, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const&, double power) {
    on[goal - first] += power;
  }
  void score_through(PathState const&, Vertex const&, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                     double power) {
    on[goal - first] += power;
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                 double power) {
    on[goal - first] += power;
  }
  std::uint32_t first;
  double scattered = 0, on[5] = {};
};

// Unit cube: the floor is lit by a beam wider than it is; the other five faces are receivers. Light that misses the
// floor is lost, so the means are of (arrived - F scattered), whose truth is zero.
struct Cube {
  Sampler opposite, adjacent, all, control;
};
Cube cube(std::uint64_t histories) {
  World world;
  BodyId const body = world.add_body("cube", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  auto const face = [&](Vec3 inward, std::uint32_t optic) {
    Rectangle square = rectangle(1, 1);
    Vec3 const e1{inward.y, inward.z, inward.x};
    square.place({-0.5 * inward, e1, cross(inward, e1), inward});
    return world.add_surface(square, optic, black, body, world.add_group("face"));
  };
  SurfaceId const floor = face({0, 0, 1}, white);
  for (Vec3 const inward : {Vec3{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}})
    receive_on(world, "face", face(inward, black));
  world.add_footprint(spot(floor, {0, 0, -0.5}, {0, 0, -1}, Profile::even, std::sqrt(0.5)));
  world.limits.max_order = 1;
  prepare(world);
  Cube result;
  Arrivals a(world);
  walk(world, histories, a, [&] {
    double const sides = a.on[1] + a.on[2] + a.on[3] + a.on[4];
    result.opposite.add(a.on[0] - 0.199825 * a.scattered);
    result.adjacent.add(0.25 * sides - 0.200044 * a.scattered);
    result.all.add(a.on[0] + sides - a.scattered);
    result.control.add(0.25 * sides - 0.202 * a.scattered);
    a = Arrivals(world);
  });
  return result;
}
TEST(ViewFactorsReceived, UnitCubeScene3) {
  Cube const c = cube(5 << 18);
  double const emitted = 2 / pi;  // the square's share of the beam
  expect_mean("opposite", c.opposite.mean(), 0, 5e-3 * 0.199825 * emitted);
  expect_mean("adjacent", c.adjacent.mean(), 0, 5e-3 * 0.200044 * emitted);
  expect_mean("all five", c.all.mean(), 0, 4e-3 * emitted);
  expect_rejected("1 % more", c.control.mean(), 0);
}

// Wall of a cylinder of radius 1 to itself: 1 - (f(z) + f(h - z)) from height z, f to a disc. Eight points of the Gauss
// rule, as sources whose shares are its weights, give the mean over the wall.
double wall_to_end(double z) { return (0.25 * z * z + 0.5) / std::sqrt(0.25 * z * z + 1) - 0.5 * z; }
constexpr double gauss_point[] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623},
                 gauss_weight[] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626};

// A thin beam from the axis lights each point; the wall then sees itself.
SampleMean wall_to_itself(double h, std::uint64_t histories, double even_shares = 0) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  SurfaceId const wall = world.add_surface(cylinder(1, 0, h), black, white, body, world.add_group("wall"));
  receive_on(world, "wall", wall, false, true);
  double closed = 0;
  for (int i = 0; i < 8; ++i) {
    double const z = 0.5 * h * (1 + (i < 4 ? gauss_point[i] : -gauss_point[i - 4])), weight = 0.5 * gauss_weight[i % 4];
    Footprint f = free_beam(world.add_group("beam"), {0, 0, z}, {1, 0, 0}, Profile::point, 0);
    f.share = even_shares > 0 ? even_shares : weight;
    world.add_footprint(f);
    closed += weight * (1 - wall_to_end(z) - wall_to_end(h - z));
  }
  EXPECT_NEAR(closed, 1 - (1 - coaxial(1, 1, h)) / h, 1e-7);  // by reciprocity and closure of wall and ends
  world.limits.max_order = 2;
  prepare(world);
  TraceResult const r = run_histories(world, histories);
  for (CouplingClass const& c : r.coupling.received)
    if (received_name(r.coupling, c) == "beam·B > wall·S > wall·D")
      return {c.coupling.mean, c.coupling.std_error, (long long)r.total.histories};
  return {};
}
TEST(ViewFactorsReceived, CylinderWallToItselfScene3) {
  SampleMean const half = wall_to_itself(1, 1 << 19), one = wall_to_itself(2, 1 << 19);
  expect_mean("H = 0.5", half, 0.381966, 4e-3 * 0.381966);
  expect_mean("H = 1", one, 0.585786, 5.6e-3 * 0.585786);
  expect_rejected("heights counted alike", wall_to_itself(2, 1 << 17, 0.125), 0.585786);
}

}  // namespace
}  // namespace straytrace::testing::trace_view_factors_received
