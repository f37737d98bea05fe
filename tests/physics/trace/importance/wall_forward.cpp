// SPDX-License-Identifier: BSD-3-Clause
// Case A12, docs/theory/arm.md: mirror -> diffuse wall -> far mirror, one direction, and the phase sensitivity of the
// wall.
#include "support/aimed_walls.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::testing::trace_wall_forward {
namespace {

constexpr double kappa = 1e-6, radius = 0.6, arm = 3000, first = 10, beta_wall = 1e-2;
constexpr double lambda = 1.064e-6, k = 2 * pi / lambda;
constexpr char const *near_route = "mirror 1·S > near wall·S > mirror 2·S",
                     *far_route = "mirror 1·S > far wall·S > mirror 2·S";

World tube() {
  World world;
  BodyId const optics = world.add_body("optics", {}), pipe = world.add_body("pipe", {});
  std::uint32_t const mirror = power_law_optic(world, kappa, 2, 5e-5), black = black_optic(world);
  SurfaceId const one =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.175}, mirror, black, optics, world.add_group("mirror 1"));
  SurfaceId const two =
      world.add_surface(Disk{{0, 0, arm}, {0, 0, -1}, 0, 0.175}, mirror, black, optics, world.add_group("mirror 2"));
  std::uint32_t const steel = lambertian_optic(world, pi * beta_wall);
  world.add_surface(Cylinder{{}, {0, 0, 1}, radius, first, arm / 2}, black, steel, pipe, world.add_group("near wall"));
  world.add_surface(Cylinder{{}, {0, 0, 1}, radius, arm / 2, arm - first}, black, steel, pipe,
                    world.add_group("far wall"));
  Footprint source = spot(one, {}, {0, 0, -1}, Profile::point, 0);
  Footprint receiver = spot(two, {0, 0, arm}, {0, 0, 1}, Profile::point, 0, world.add_port("mirror 2"));
  receiver.emits = false;
  world.add_footprint(source);
  world.add_footprint(receiver);
  world.limits.max_order = 2;
  world.finish();
  return world;
}

// Path integral eq. 1.2 over the wall of the near half, exact in the angles; `phase sensitivity`: times the squared
// radial phase sensitivity.
double near_half(bool phase_sensitivity) {
  double sum = 0;
  constexpr int steps = 100000;
  double const span = std::log((arm - first) / first);
  for (int i = 0; i < steps; ++i) {  // midpoints in u = ln(z/(L - z))
    double const u = -span * (i + 0.5) / steps, z = arm / (1 + std::exp(-u)), dz = z * (arm - z) / arm;
    double const l1 = std::hypot(z, radius), l2 = std::hypot(arm - z, radius), s1 = radius / l1, s2 = radius / l2;
    double const b1 = kappa / std::pow(std::atan2(radius, z), 2), b2 = kappa / std::pow(std::atan2(radius, arm - z), 2);
    double const mirrors = std::sqrt((1 - s1 * s1) * (1 - s2 * s2)), j = k * (s1 + s2);
    sum += b1 * b2 * beta_wall * mirrors * s1 * s2 / (l1 * l1 * l2 * l2) * 2 * pi * radius * dz *
           (phase_sensitivity ? j * j : 1);
  }
  return lambda * lambda * sum * span / steps;
}

double const closed =
    4 * pi * lambda * lambda * kappa * kappa * beta_wall / (radius * arm) * std::log((arm - first) / first);

TEST(WallForward, ClosedFormEq8_7) {
  EXPECT_NEAR(closed, 4.5054e-28, 1e-4 * closed);
  EXPECT_NEAR(2 * near_half(false), closed, 1e-3 * closed);  // the small-angle form is good to this
}

// Each half of the wall in strips of about equal shares, aimed at by light of mirror 1: the halves couple alike, but
// the BSDF model alone seldom meets what lies right before mirror 2.
void aim_at_all_of_the_wall(World& world) {
  double const area = 2 * pi * radius * (arm / 2 - first), from[] = {10, 20, 45, 100, 220, 500, 1000, 1500};
  AimedWall near{SurfaceId{2}, area, {}}, far{SurfaceId{3}, area, {}};
  for (double z : from) {
    near.edges.push_back((z - first) / (arm / 2 - first));
    far.edges.insert(far.edges.begin(), 1 - near.edges.back());
  }
  world.steer(aimed_walls(world, SurfaceId{0}, {near, far}));
}

TEST(WallForward, TracedA12) {
  World world = tube();
  aim_at_all_of_the_wall(world);
  TraceResult const r = run_histories(world, 1 << 19);
  SampleMean const half = route_coupling(r, near_route), far = route_coupling(r, far_route);
  double const exact = near_half(false);  // 4e-4 below the small-angle form, which the errors resolve
  expect_mean("near half", half, exact, 1e-3 * exact);
  expect_mean("far half", far, exact, 1e-3 * exact);
  SampleMean const whole{half.mean + far.mean, half.std_error + far.std_error, half.n};
  expect_mean("whole arm", whole, 2 * exact, 1e-3 * 2 * exact);
  expect_rejected("small angles", whole, closed);
  expect_rejected("C_rev already applied", half, closed);
  expect_rejected("wall from 11 m on", half, closed / 2 * std::log(2989 / 11.0) / std::log(299.0));
  expect_rejected("whole arm, wall from 11 m on", whole, closed * std::log(2989 / 11.0) / std::log(299.0));
  CouplingClass const* c = find_route(r, near_route);
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->reverse, 2);  // one beam: the mirrors of one arm
}

// Squared radial phase sensitivity of every path over the near wall, and how far any phase sensitivity is from eq. 8.8.
struct Listener : Silent {
  World const& world;
  double now = 0, worst = 0, control = 0;
  Sampler f_lever2;
  explicit Listener(World const& w) : world(w) {}
  void score(PathState const& path, Vertex const& v, std::uint32_t, std::uint32_t number, Vertex const&, double f) {
    auto const found = replay(SteeredWorld::as_given(world), 1, path.history, path.event, number);
    if (!found || found->vertices.size() != 3) return;
    double const z = v.point.z, l1 = std::hypot(z, radius), l2 = std::hypot(arm - z, radius);
    for (PhaseSensitivity const& l : found->phase_sensitivities)
      if (world.bodies()[l.body.value].name == "pipe") {
        double const radial = std::hypot(l.d[0], l.d[1]);
        worst = std::fmax(worst, std::fabs(radial - k * (radius / l1 + radius / l2)) / radial);
        worst = std::fmax(worst, std::fabs(l.d[2] - k * (z / l1 - (arm - z) / l2)) / radial);
        control = std::fmax(control, std::fabs(radial - k * (radius / l1 - radius / l2)) / radial);
        if (z < arm / 2) now += f * radial * radial;
      }
  }
  void close() {
    f_lever2.add(now);
    now = 0;
  }
};

TEST(WallForward, PhaseSensitivityEq8_8) {
  World const world = tube();
  Listener phase_sensitivities(world);
  walk(world, 1 << 18, phase_sensitivities, [&] { phase_sensitivities.close(); });
  EXPECT_LT(phase_sensitivities.worst, 1e-9);
  EXPECT_GT(phase_sensitivities.control, 1e-9);  // the difference of the sines
  double const expected = near_half(true);
  expect_mean("f times squared phase sensitivity", phase_sensitivities.f_lever2.mean(), expected, 0.1 * expected);
  double const middle = k * radius * 4 / arm;  // phase sensitivity of the middle of the arm
  expect_rejected("mid-arm phase sensitivity for all", phase_sensitivities.f_lever2.mean(),
                  near_half(false) * middle * middle);
}

}  // namespace
}  // namespace straytrace::testing::trace_wall_forward
