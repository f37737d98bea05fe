// SPDX-License-Identifier: BSD-3-Clause
// requirements.md E.1: empty tube with a reflecting wall, 1/theta^2 mirrors, even weight on the far mirror (physics.md
// 8.4, 8.6); and A13, the prefactor of the 1997 formula. One direction, one arm, phi_0 = 0.
#include "optics/power_law.hpp"
#include "trace/tally/replay.hpp"
#include "trace_support.hpp"

namespace straytrace::testing::trace_arm_tube {
namespace {

constexpr double tube_radius = 0.6, mirror_radius = 0.175, arm = 3000, loss = 1e-6, above = 55e-6;
constexpr double lambda = 1.064e-6, k = 2 * pi / lambda, wall_motion = 0.075e-6;  // m, rms amplitude of each axis

// |u|^2 of mirror 2: even over its face, or (for a twin) Gaussian of that radius.
World arm_tube(Profile profile = Profile::even) {
  World world;
  BodyId const optics = world.add_body("optics", {}), pipe = world.add_body("pipe", {});
  double const kappa = loss * statistical_kappa(above) / (2 * pi);  // eq. 3.19
  std::uint32_t const mirror = power_law_optic(world, kappa, 2, above), black = black_optic(world);
  SurfaceId const one =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, mirror_radius}, mirror, black, optics, world.add_group("mirror 1"));
  SurfaceId const two = world.add_surface(Disk{{0, 0, arm}, {0, 0, -1}, 0, mirror_radius}, mirror, black, optics,
                                          world.add_group("mirror 2"));
  world.add_surface(Cylinder{{}, {0, 0, 1}, tube_radius, 0, arm}, black, mirror_optic(world, 1), pipe,
                    world.add_group("wall"));
  world.add_footprint(spot(one, {}, {0, 0, -1}, Profile::point, 0));
  Footprint f = spot(two, {0, 0, arm}, {0, 0, 1}, profile, mirror_radius, world.add_port("mirror 2"));
  f.emits = false;
  world.add_footprint(f);
  world.limits.max_order = 4;
  world.limits.route_vertices = 6;
  world.finish();
  return world;
}

double order_share(int m) {  // eq. 8.4: of the light scattered out of mirror 1
  double const t1 = (2 * m * tube_radius - mirror_radius) / arm, t2 = (2 * m * tube_radius + mirror_radius) / arm;
  return statistical_kappa(above) * std::log(t2 / t1);
}
double prefactor() { return lambda * lambda * loss / (std::sqrt(32.0) * pi * pi * arm * mirror_radius); }  // eq. 8.15
double order_line(int m) {  // eq. 8.10, two axes
  double const t1 = (2 * m * tube_radius - mirror_radius) / arm, t2 = (2 * m * tube_radius + mirror_radius) / arm;
  return prefactor() * statistical_kappa(above) * k * wall_motion * std::sqrt(2 * std::log(t2 / t1));
}

TEST(ArmTube, ClosedForms) {
  EXPECT_NEAR(statistical_kappa(above), 0.0993409, 5e-8);
  EXPECT_NEAR(prefactor(), 3.86233e-23, 5e-29);
  EXPECT_NEAR(statistical_kappa(above) * statistical_integral(above, mirror_radius / arm), 5.845e-3, 5e-7);
  EXPECT_NEAR(order_share(1), 0.029183, 5e-7);
  EXPECT_NEAR(order_share(2), 0.014513, 5e-7);
  EXPECT_NEAR(order_line(1), 1.3025e-24, 5e-29);
}

// Power that arrives on mirror 2 after m wall hits, and h^2 of the line made by light rejoining there.
struct Orders : Silent {
  World const& world;
  std::vector<PassedVertex> passed;
  double share[4] = {}, line2[4] = {};
  explicit Orders(World const& w) : world(w) {}
  void start(Vec3 out) { passed = {{SurfaceId{0}, {}, {0, 0, -1}, out, Event::emit}}; }
  void visit(PathState const& path, Vertex const& v) {
    passed.push_back({v.surface, v.point, passed.back().out, {}, Event::reflect});
    Vec3 const d = path.ray.dir, n = v.frame.e3;
    passed.back().out = d - (2 * dot(d, n)) * n;
    if (v.surface.value == 1 && path.order <= 4) share[path.order - 1] += path.power;
  }
  void score(PathState const& path, Vertex const&, std::uint32_t lit, std::uint32_t number, Vertex const&, double f) {
    if (!by_itself(number) || path.order > 4 || passed.back().surface.value != 1) return;
    auto vertices = passed;
    vertices.back().out = {0, 0, -1};
    for (Lever const& l : levers_of(world, vertices, 0, lit))
      if (world.bodies()[l.body.value].name == "pipe")  // h = (lambda/4 pi L) sqrt(f) sin(phi), phi small
        line2[path.order - 1] += f * std::pow(lambda / (4 * pi * arm), 2) * (l.d[0] * l.d[0] + l.d[1] * l.d[1]) *
                                 wall_motion * wall_motion / 2;
  }
};

// The program's step on directions at equal shares of the scatter law's own density: a quadrature, good to 0.1 %.
Orders quadrature(World const& world) {
  constexpr int n = 1 << 19;
  WorldView const view = world.view();
  PowerLaw const law = power_law(loss * statistical_kappa(above) / (2 * pi), 2, above);
  Orders orders(world);
  for (int i = 0; i < n; ++i) {
    double const azimuth = std::fmod(0.618033988749895 * i, 1.0);
    BsdfSample const s = law.sample({0, 0, 1}, (i + 0.5) / n, azimuth);
    if (!(s.pdf > 0)) continue;
    History history;
    PathState& path = history.path;
    path.from = SurfaceId{0};
    path.ray.dir = s.wo;
    path.power = law.eval({0, 0, 1}, s.wo) * s.wo.z / s.pdf / n;
    path.emitted = loss / n;
    path.hop.law_pdf = path.hop.value = s.pdf;
    orders.start(s.wo);
    while (path.order < 4 && step(view, 1, history, orders) && orders.passed.back().surface.value != 1) {
    }
  }
  return orders;
}

TEST(ArmTube, OrdersByQuadratureE1) {
  Orders const o = quadrature(arm_tube());
  EXPECT_NEAR(o.share[0] / loss, 5.845e-3, 1e-3 * 5.845e-3);
  EXPECT_NEAR(o.share[1] / loss, 0.029183, 1e-3 * 0.029183);
  EXPECT_NEAR(o.share[2] / loss, 0.014513, 1e-3 * 0.014513);
  EXPECT_NEAR(o.share[3] / loss, order_share(3), 1e-3 * order_share(3));
  EXPECT_NEAR(std::sqrt(o.line2[1]), 1.3025e-24, 1e-3 * 1.3025e-24);
  EXPECT_NEAR(std::sqrt(o.line2[3]), order_line(3), 1e-3 * order_line(3));
  EXPECT_LT(std::sqrt(o.line2[2]), 1e-9 * 1.3025e-24);  // opposite walls of a rigid tube cancel
  EXPECT_EQ(o.line2[0], 0);
  Orders const twin = quadrature(arm_tube(Profile::gaussian));  // trap 14.2: the mirror weight
  EXPECT_GT(std::fabs(std::sqrt(twin.line2[1]) - 1.3025e-24), 1e-3 * 1.3025e-24);
}

TEST(ArmTube, FirstOrderTracedE1) {
  World world = arm_tube();
  TraceResult const r = run_histories(world, 1 << 20);
  CouplingClass const* c = find_route(r, "mirror 1·S > wall·R > mirror 2·S");
  ASSERT_NE(c, nullptr);
  // f = (eps kappa_s lambda)^2/(2 pi^2 R_m^2) int dtheta/theta^3, eq. 1.7 with even weight
  double const t1 = (2 * tube_radius - mirror_radius) / arm, t2 = (2 * tube_radius + mirror_radius) / arm;
  double const expected = std::pow(loss * statistical_kappa(above) * lambda / (pi * mirror_radius), 2) / 4 *
                          (1 / (t1 * t1) - 1 / (t2 * t2));
  SampleMean const f = sample_mean(c->coupling, (long long)r.total.histories);
  expect_mean("m = 1", f, expected, 5e-2 * expected);
  expect_rejected("m = 1, the clipped law of the original (13.3 times low)", f, expected / 13.3);
  // the line from the kept records: 512 of them know it to 1 %
  double line2 = 0;
  for (PathRecord const& p : c->records)
    for (Lever const& l : p.levers)
      if (world.bodies()[l.body.value].name == "pipe")
        line2 += p.weight * (l.d[0] * l.d[0] + l.d[1] * l.d[1]) * wall_motion * wall_motion / 2;
  EXPECT_NEAR(std::sqrt(line2) * lambda / (4 * pi * arm), 1.3025e-24, 3e-2 * 1.3025e-24);
  CouplingClass const* even = find_route(r, "mirror 1·S > wall·R > wall·R > mirror 2·S");
  ASSERT_NE(even, nullptr);
  for (PathRecord const& p : even->records)
    for (Lever const& l : p.levers)
      if (world.bodies()[l.body.value].name == "pipe") {
        EXPECT_LT(std::hypot(l.d[0], l.d[1]), 1e-6 * k * t1);
      }
}

// A13, eq. 8.15: h of one path of power eps that arrives at angle theta, without its lever.
double path_constant(Profile profile, double theta) {
  struct Catch : Silent {
    double f = 0;
    void score(PathState const&, Vertex const&, std::uint32_t, std::uint32_t, Vertex const&, double c) { f = c; }
  } caught;
  World const world = arm_tube(profile);
  History history;
  PathState& path = history.path;
  path.from = SurfaceId{2};
  path.ray.origin = {-theta * 1, 0, arm - 1};
  path.ray.dir = unit({theta, 0, 1});
  path.power = path.emitted = loss;
  step(world.view(), 1, history, caught);
  double const b = statistical_kappa(above) / std::pow(std::atan(theta), 2);
  return lambda / (4 * pi * arm) * std::sqrt(caught.f) /
         (lambda * lambda * loss / (arm * mirror_radius) * std::sqrt(b));
}
TEST(ArmTube, PrefactorOf1997A13) {
  EXPECT_NEAR(1 / (std::sqrt(32.0) * pi * pi), 0.0179112240, 5e-11);
  for (double const theta : {1e-4, 4e-4, 1e-2}) {
    EXPECT_NEAR(path_constant(Profile::even, theta), 0.0179112240, 1e-10) << theta;
    EXPECT_GT(std::fabs(path_constant(Profile::gaussian, theta) - 0.0179112240), 1e-10);  // twin
  }
}

}  // namespace
}  // namespace straytrace::testing::trace_arm_tube
