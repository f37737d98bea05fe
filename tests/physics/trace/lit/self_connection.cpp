// SPDX-License-Identifier: BSD-3-Clause
// A concave mirror sees itself. On a sphere the exchange between any two points is cos cos/d^2 = 1/(4 R^2), so two
// Lambertian scatters on one cap give f = lambda^2 beta^2/(4 R^2) at any position of the cap
// (docs/theory/path_integral.md, eq. 1.2).
#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing::trace_self_connection {
namespace {

constexpr double lambda = 1.064e-6, roc = 1683, beta = 1e-3;

SampleMean self_exchange(double z) {
  World world;
  BodyId const body = world.add_body("mirror", {});
  PortId const port = world.add_port("mirror");
  Cap cap;
  cap.curvature = 1 / roc;
  cap.outer_radius = 0.3;
  cap.place(facing_along({0, 0, z}, {0, 0, -1}));
  SurfaceId const s =
      world.add_surface(cap, lambertian_optic(world, pi * beta), black_optic(world), body, world.add_group("mirror"));
  Footprint lit = spot(s, {0, 0, z}, {0, 0, 1}, Profile::gaussian, 0.05, port);
  lit.standing = true;
  world.add_footprint(lit);
  world.finish();
  return total_coupling(run_histories(world, 1 << 18));
}

TEST(SelfConnection, ConcaveMirrorCouplesToItselfFarFromTheOriginEq1_2) {
  double const expected = lambda * lambda * beta * beta / (4 * roc * roc);
  for (double const z : {0.0, 2999.8, 4e4}) {
    SampleMean const f = self_exchange(z);
    EXPECT_NEAR(f.mean, expected, 2e-3 * expected) << "at z = " << z;
  }
}

TEST(SelfConnection, AFactorOfTwoWouldBeFound) {
  double const control = 0.5 * lambda * lambda * beta * beta / (4 * roc * roc);
  EXPECT_GT(std::abs(self_exchange(2999.8).mean - control), 0.4 * control);
}

// A deep bowl under even light, in which the walk meets the lit surface too.
World bowl_world() {
  World world;
  BodyId const body = world.add_body("bowl", {});
  Cap bowl;
  bowl.curvature = 1;
  bowl.outer_radius = 0.9;
  bowl.place(facing_along({}, {0, 0, -1}));
  SurfaceId const s =
      world.add_surface(bowl, lambertian_optic(world, 0.5), black_optic(world), body, world.add_group("bowl"));
  Footprint lit = spot(s, {}, {0, 0, 1}, Profile::even, 0.9, world.add_port("bowl"));
  lit.standing = true;
  world.add_footprint(lit);
  world.finish();
  return world;
}
// A connection is made with this probability; 0: that of the tables.
SampleMean in_a_bowl(double probability) {
  World world = bowl_world();
  SteeringTables tables = make_importance(world);
  for (float& each : tables.connections)
    if (probability > 0) each = float(probability);
  world.steer(tables);
  return scaled(route_coupling(run_histories(world, 1 << 17), "bowl·S > bowl·S"), 16 * pi * pi / (lambda * lambda));
}

TEST(SelfConnection, RareConnectionsKeepTheMeanEq1_27) {
  expect_mean("probability 1/8", in_a_bowl(0.125), 1, 3e-2);
  expect_mean("as the tables say", in_a_bowl(0), 1, 3e-2);
  expect_rejected("hits of the walk left out", in_a_bowl(0.125), 0.8);
}

// All vertices of a history are connected to one point of a goal, each history to its own (docs/theory/sampling.md,
// Strata); the walk's own hits lie anywhere.
struct PointsOfGoal : NullSink {
  std::vector<Vec3> connected, hit;
  void score(PathState const&, Vertex const&, std::uint32_t, std::uint32_t number, Vertex const& y, double) {
    (is_hit(number) ? hit : connected).push_back(y.point);
  }
};
TEST(SelfConnection, VerticesOfAHistoryShareTheirPoint) {
  World const world = bowl_world();
  std::size_t several = 0, apart = 0;
  std::vector<Vec3> firsts;
  for (std::uint64_t history = 0; history < 200; ++history) {
    PointsOfGoal sink;
    trace_history(world.view(), 1, history, sink);
    for (Vec3 const& y : sink.connected) EXPECT_EQ(length(y - sink.connected[0]), 0) << history;
    for (Vec3 const& y : sink.hit) apart += length(y - sink.hit[0]) > 1e-3;
    several += sink.connected.size() > 1;
    if (!sink.connected.empty()) firsts.push_back(sink.connected[0]);
  }
  EXPECT_GT(several, 50u);
  EXPECT_GT(apart, 10u);
  for (std::size_t i = 1; i < firsts.size(); ++i) EXPECT_GT(length(firsts[i] - firsts[i - 1]), 1e-6);
}

// The light of one mirror on a baffle before it is worth nothing against that of the other mirror.
TEST(SelfConnection, TablesMakeFaintConnectionsRareEq1_27) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const glossy = power_law_optic(world, 1e-3, 2, 1e-4), black = black_optic(world);
  for (double const z : {0.0, 1000.0}) {
    double const way = z > 0 ? 1 : -1;
    Cap mirror;
    mirror.curvature = 1 / roc;
    mirror.outer_radius = 0.2;
    mirror.place(facing_along({0, 0, z}, {0, 0, -way}));
    std::string const name = z > 0 ? "far" : "near";
    SurfaceId const s = world.add_surface(mirror, glossy, black, body, world.add_group(name));
    Footprint lit = spot(s, {0, 0, z}, {0, 0, way}, Profile::gaussian, 0.05, world.add_port(name), z > 0 ? 1 : 0);
    lit.standing = true;
    world.add_footprint(lit);
  }
  SurfaceId const baffle = world.add_surface(disk(0.3, 0.4, {{0, 0, 20}, {0, 0, 1}}), lambertian_optic(world, 0.1),
                                             lambertian_optic(world, 0.1), body, world.add_group("baffle"));
  world.finish();
  SteeringTables const tables = make_importance(world);
  Steering const view = tables.view();
  auto const side = [&](SurfaceId id) { return 2 * view.strips[view.first_of_surface[id.value]].patch; };
  EXPECT_EQ(view.connection(side(SurfaceId{0}), 0), 0.125);  // of a mirror with itself
  EXPECT_EQ(view.connection(side(SurfaceId{0}), 1), 1);
  EXPECT_EQ(view.connection(side(baffle) + 1, 0), 1);  // its back sees the near mirror
}

}  // namespace
}  // namespace straytrace::testing::trace_self_connection
