// SPDX-License-Identifier: BSD-3-Clause
// Scene 11 of estimators.md 17: a baffled tube of 4 km, and the missed-path trap of its section 15. A mirror's spot
// scatters into the tube; receiver A is the mirror itself, receiver B a photodiode of 1 cm^2 hidden behind a far ring.
#include <gtest/gtest.h>

#include "base/message.hpp"
#include "shapes.hpp"
#include "trace/estimate/importance.hpp"
#include "trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr double tube_radius = 0.6, tube_length = 4000, rim = 0.5;

std::vector<double> ring_heights() {
  std::vector<double> z;
  for (double at = 20; at < 2000; at *= 1.18) z.push_back(at);
  std::size_t const half = z.size();
  for (std::size_t i = half; i-- > 0;) z.push_back(tube_length - z[i]);
  return z;
}

World baffled_tube() {
  World world;
  Abg law;
  law.a = 1e-6;
  law.b = 1e-8;
  law.g = 2;
  law.prepare();
  Optic mirror;
  mirror.laws = 1;
  mirror.law[0] = world.add_law(law);
  std::uint32_t const black = black_optic(world), wall = lambertian_optic(world, 0.3),
                      ring = lambertian_optic(world, 0.003);
  BodyId const body = world.add_body("all", {});
  SurfaceId const m = world.add_surface(disk(0, 0.17, {{}, {0, 0, 1}}), world.add_optic(mirror), black, body,
                                        world.add_group("mirror"));
  world.add_surface(cylinder(tube_radius, 0, tube_length), black, wall, body, world.add_group("wall"));
  GroupId const rings = world.add_group("rings");
  double photodiode = 0;
  for (double const z : ring_heights()) {
    world.add_surface(disk(rim, tube_radius, {{0, 0, z}, {0, 0, 1}}), ring, ring, body, rings);
    if (z > 1500 && photodiode == 0) photodiode = z - 1;
  }
  for (double const z : {-1e-3, tube_length})
    world.add_surface(disk(0, tube_radius, {{0, 0, z}, {0, 0, 1}}), black, black, body, world.add_group("end"));
  Rectangle chip;
  chip.width = chip.height = 1e-2;
  chip.place(facing_along({tube_radius - 1e-3, 0, photodiode}, {-1, 0, 0}));
  SurfaceId const b = world.add_surface(chip, black, black, body, world.add_group("photodiode"));
  world.add_footprint(spot(m, {}, {0, 0, -1}, Profile::point, 0));
  Receiver a_receiver, b_receiver;
  a_receiver.surface = m;
  b_receiver.surface = b;
  world.add_receiver("A", a_receiver);
  world.add_receiver("B", b_receiver);
  world.limits.max_order = 6;
  world.limits.route_vertices = 8;
  world.finish();
  return world;
}

SampleMean received(TraceResult const& r, std::uint32_t receiver, bool ring_first = false) {
  double mean = 0, variance = 0;
  for (CouplingClass const& c : r.coupling.received) {
    if (c.port.value != receiver) continue;
    if (ring_first && (c.steps.size() < 2 || r.coupling.groups[c.steps[1].group.value] != "rings")) continue;
    mean += c.coupling.mean;
    variance += c.coupling.std_error * c.coupling.std_error;
  }
  return {mean, std::sqrt(variance), (long long)r.total.histories};
}

// The walls of the first 20 m, before the first ring, taken off every list.
SteeringTables without_near_wall(World const& world, SteeringTables tables, double alpha) {
  SteeringTables changed = tables;
  changed.targets.clear();
  for (PatchSide& side : changed.sides) {
    std::uint32_t const first = std::uint32_t(changed.targets.size());
    double total = 0;
    for (std::uint32_t i = side.first; i < side.first + side.count; ++i) {
      Target t = tables.targets[i];
      Strip const& strip = tables.strips[t.patch];
      bool const near_wall =
          world.groups()[world.surfaces()[strip.surface.value].group.value] == "wall" && strip.u_low * tube_length < 20;
      if (near_wall) continue;
      total += t.share;
      changed.targets.push_back(t);
    }
    double so_far = 0;
    side.first = first;
    side.count = std::uint32_t(changed.targets.size()) - first;
    for (std::uint32_t i = first; i < changed.targets.size(); ++i) {
      changed.targets[i].share /= total;
      changed.targets[i].cumulative = so_far += changed.targets[i].share;
    }
    side.alpha = side.count > 0 ? alpha : 1;
  }
  changed.level = 0;
  return changed;
}

void expect_same(char const* what, SampleMean a, SampleMean b) {
  EXPECT_LT(std::fabs(a.mean - b.mean), 5 * std::hypot(a.std_error, b.std_error)) << what << a.mean << " " << b.mean;
}
double relative(SampleMean s) { return s.std_error / s.mean; }

// Scatter law alone, targets at the first hop alone, targets at every hop with weight windows, and waiting for hits.
TEST(BaffledTube, EstimatorsAgreeScene11) {
  World world = baffled_tube();
  TraceResult const law = run_histories(world, 1 << 18);
  SteeringTables const tables = make_importance(world);
  SteeringTables first_hop = tables;
  for (std::size_t i = 0; i < first_hop.sides.size(); ++i)
    if (tables.strips[i / 2].surface.value != 0) first_hop.sides[i].alpha = 1;
  first_hop.level = 0;
  world.steer(first_hop);
  TraceResult const first = run_histories(world, 1 << 18);
  world.steer(tables);
  TraceResult const every = run_histories(world, 1 << 18);
  for (TraceResult const* r : {&first, &every}) {
    expect_same("A ", received(*r, 0), received(law, 0));
    expect_same("B ", received(*r, 1), received(law, 1));
    expect_same("first hit on a ring ", received(*r, 0, true), received(law, 0, true));
    EXPECT_LT(relative(received(*r, 0)), 1e-2);
    EXPECT_TRUE(r->coupling.warnings.empty());
  }
  SampleMean const brute = arrived(world, law, "mirror");  // per power scattered by the spot
  double const emitted = law.total.emitted.sum / double(law.total.histories);
  expect_same("A by waiting ", {brute.mean * emitted, brute.std_error * emitted, brute.n}, received(law, 0));
  // what aiming is for: the hidden photodiode, at equal histories (estimators.md 16)
  EXPECT_LT(relative(received(every, 1)), relative(received(law, 1)) / 3);
  EXPECT_LT(relative(received(every, 0, true)), relative(received(law, 0, true)));
}

// The trap of section 15: the wall before the first ring, through which most light comes back, is on no list.
TEST(BaffledTube, MissedPathTrap) {
  World world = baffled_tube();
  TraceResult const law = run_histories(world, 1 << 18);
  SteeringTables const tables = make_importance(world);
  world.steer(without_near_wall(world, tables, 0.1));
  TraceResult const insured = run_histories(world, 1 << 19);
  expect_same("A ", received(insured, 0), received(law, 0));
  std::vector<std::string> const& warnings = insured.coupling.warnings;
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("receiver A comes from 'wall'"), std::string::npos) << warnings[0];
  // exclusive lists: the books see that light is missing
  world.steer(without_near_wall(world, tables, 0));
  EXPECT_THROW(run_histories(world, 1 << 18), NumericalError);
}

}  // namespace
}  // namespace straytrace::testing
