// SPDX-License-Identifier: BSD-3-Clause
// One technique at a time (docs/theory/sampling.md): a laser lights a square, a second one at right angles to it
// passes the light on to a receiver. Thin plates of index 1 change nothing but what can be connected: each technique
// has to carry the whole result alone, and in company. Truth: quadrature of eq. 1.2 over the second square and the
// receiver.
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_techniques {
namespace {

constexpr double rho = 0.8, lit_x = 0.5, low = 0.2, high = 1.2, middle = 0.7;  // m; square B: |y| < 0.5, low < z < high

struct Layout {
  double laser = 1;                   // m above the first square
  double distance = 1, radius = 0.5;  // m, of the receiver from the second square
  bool before_source = false, between = false, before_receiver = false;
  bool covered = true;  // receivers behind glass are looked for
  double index = 1;
};

// Rectangle of these sizes along y and across, normal `normal`.
Rectangle square(Vec3 centre, Vec3 normal, double along_y, double across) {
  Rectangle r = rectangle(along_y, across);
  r.place({centre, {0, 1, 0}, cross(normal, {0, 1, 0}), normal});
  return r;
}
void add_tilted_plate(World& world, Vec3 centre, Vec3 normal, double along_y, double across, double index) {
  std::uint32_t const bare = glass_optic(world), volume = world.add_volume({index, 0});
  BodyId const body = world.add_body("glass", {});
  for (double const side : {-1.0, 1.0})
    world.add_surface(square(centre + side * 2e-3 * normal, side * normal, along_y, across), bare, bare, body,
                      world.add_group("glass"), volume);
}

World scene(Layout const& s) {
  World world;
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  BodyId const body = world.add_body("all", {});
  world.add_surface(square({lit_x, 0, 0}, {0, 0, 1}, 0.4, 0.4), white, black, body, world.add_group("A"));
  world.add_surface(square({0, 0, middle}, {1, 0, 0}, 1, 1), white, black, body, world.add_group("B"));
  receive_on(world, "receiver",
             world.add_surface(disk(0, s.radius, {{s.distance, 0, middle}, {-1, 0, 0}}), black, black, body,
                               world.add_group("receiver")));
  double const wide = 3 * std::fmax(1, s.radius);
  if (s.before_source) add_tilted_plate(world, {lit_x, 0, 0.8 * s.laser}, {0, 0, 1}, 0.1, 0.1, s.index);
  if (s.between) add_tilted_plate(world, {lit_x - 0.057, 0, 0.057}, unit({-1, 0, 1}), 0.3, 0.13, s.index);
  if (s.before_receiver) add_tilted_plate(world, {s.distance - 0.25, 0, middle}, {1, 0, 0}, wide, wide, s.index);
  world.add_footprint(free_beam(world.add_group("laser"), {lit_x, 0, s.laser}, {0, 0, -1}, Profile::point, 0));
  world.limits.max_order = 12;
  world.limits.route_vertices = 12;
  world.finish();
  if (s.covered) find_covered_receivers(world);
  if (!s.between) world.steer(make_importance(world));  // what is aimed at through a plate counts as hidden
  EXPECT_TRUE(world.receivers()[0].behind_glass || !(s.covered && s.before_receiver));
  return world;
}

// Watts on the receiver by laser > A > B > receiver, whatever glass lies on the way.
SampleMean watts(Layout const& s, std::uint64_t histories) {
  TraceResult const r = run_histories(scene(s), histories);
  double mean = 0, variance = 0;
  for (CouplingClass const& c : r.coupling.received) {
    std::string route;
    for (PathStep const& step : c.steps)
      if (r.coupling.groups[step.group.value] != "glass") route += r.coupling.groups[step.group.value] + " ";
    if (route != "laser A B receiver ") continue;
    mean += c.coupling.mean;
    variance += c.coupling.std_error * c.coupling.std_error;
  }
  return {mean, std::sqrt(variance), (long long)r.total.histories};
}

// Midpoints: 100 x 100 on the square, 12 x 24 on the receiver.
double quadrature(Layout const& s) {
  double sum = 0;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      double const y = (i + 0.5) / 100 - 0.5, z = low + (high - low) * (j + 0.5) / 100;
      double const d2 = lit_x * lit_x + y * y + z * z, arriving = rho / pi * z * lit_x / (d2 * d2);
      double seen = 0;
      for (int k = 0; k < 12; ++k)
        for (int l = 0; l < 24; ++l) {
          double const r = s.radius * std::sqrt((k + 0.5) / 12), a = 2 * pi * (l + 0.5) / 24;
          double const across = std::pow(y - r * std::cos(a), 2) + std::pow(z - middle - r * std::sin(a), 2);
          seen += std::pow(s.distance / (s.distance * s.distance + across), 2) / (12 * 24);
        }
      sum += arriving * rho / pi * seen * pi * s.radius * s.radius * 1e-4;
    }
  return sum;
}

void compare(char const* what, Layout const& s, std::uint64_t histories, double effect) {
  double const expected = quadrature(s);
  SampleMean const w = watts(s, histories);
  expect_mean(what, w, expected, effect * expected);
}

Layout with(Layout s, bool before_source, bool between, bool before_receiver, bool covered = true) {
  s.before_source = before_source;
  s.between = between;
  s.before_receiver = before_receiver;
  s.covered = covered;
  return s;
}
constexpr double tiny = 1e-5;  // m, radius of a receiver that no walk will ever meet

TEST(Techniques, ConnectionAloneScene12) {
  Layout s;
  s.radius = tiny;
  compare("open", s, 1 << 17, 2e-2);
  compare("glass before the source", with(s, true, false, false), 1 << 17, 2e-2);
  compare("glass between the squares", with(s, true, true, false), 1 << 17, 5e-2);
}
TEST(Techniques, WalkAloneScene12) {
  compare("glass before the receiver", with({}, false, false, true, false), 1 << 19, 1.2e-1);
  // sub-paths from the receiver end on the second square, but nothing on the first can be connected to it there
  compare("glass everywhere", with({}, true, true, true), 1 << 18, 0.12);
}
TEST(Techniques, SubPathAloneScene12) {
  Layout s;
  s.radius = tiny;
  compare("glass before the receiver", with(s, true, false, true), 1 << 18, 4e-2);
}
TEST(Techniques, TogetherScene12) {
  compare("walk and connection", {}, 1 << 17, 2.5e-2);
  compare("walk and connection, glass between", with({}, false, true, false), 1 << 17, 7e-2);
  compare("walk and sub-path", with({}, false, false, true), 1 << 18, 4e-2);
}

// Source and receiver moved along their axes; the receiver keeps its solid angle. Controls: one that does not, and
// plates of index 1.5.
TEST(Techniques, DistancesScene12) {
  Layout far;
  far.laser = 20;
  far.distance = 10;
  far.radius = 2;
  compare("open", far, 1 << 17, 4e-2);
  compare("sub-path and walk", with(far, true, false, true), 1 << 17, 0.11);
  Layout s;
  s.distance = s.radius = 5;
  expect_rejected("a wider receiver", watts(with(s, false, false, false), 1 << 17), quadrature({}));
  Layout glass = with({}, false, false, true);
  glass.index = 1.5;
  expect_rejected("real glass", watts(glass, 1 << 17), quadrature({}));
}

}  // namespace
}  // namespace straytrace::testing::trace_techniques
