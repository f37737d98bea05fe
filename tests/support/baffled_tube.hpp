// SPDX-License-Identifier: BSD-3-Clause
// A baffled tube of 4 km. A mirror's spot scatters into the tube; receiver A is the
// mirror itself, receiver B a photodiode of 1 cm^2 hidden behind a far ring.
#pragma once

#include <gtest/gtest.h>

#include "base/every_module.hpp"
#include "support/laws.hpp"
#include "support/shapes.hpp"
#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing {

constexpr double baffled_radius = 0.6, baffled_length = 4000, baffled_rim = 0.5;  // m

inline std::vector<double> ring_heights() {
  std::vector<double> z;
  for (double at = 20; at < 2000; at *= 1.18) z.push_back(at);
  std::size_t const half = z.size();
  for (std::size_t i = half; i-- > 0;) z.push_back(baffled_length - z[i]);
  return z;
}

// Without receivers, light is only counted where it arrives: no connections.
inline World baffled_tube(bool with_receivers = true) {
  World world;
  Optic mirror;
  mirror.laws = 1;
  mirror.law[0] = world.add_law(abg(1e-6, 1e-8, 2));
  std::uint32_t const black = black_optic(world), wall = lambertian_optic(world, 0.3),
                      ring = lambertian_optic(world, 0.003);
  BodyId const body = world.add_body("all", {});
  SurfaceId const m = world.add_surface(disk(0, 0.17, {{}, {0, 0, 1}}), world.add_optic(mirror), black, body,
                                        world.add_group("mirror"));
  world.add_surface(cylinder(baffled_radius, 0, baffled_length), black, wall, body, world.add_group("wall"));
  GroupId const rings = world.add_group("rings");
  double photodiode = 0;
  for (double const z : ring_heights()) {
    world.add_surface(disk(baffled_rim, baffled_radius, {{0, 0, z}, {0, 0, 1}}), ring, ring, body, rings);
    if (z > 1500 && photodiode == 0) photodiode = z - 1;
  }
  for (double const z : {-1e-3, baffled_length})
    world.add_surface(disk(0, baffled_radius, {{0, 0, z}, {0, 0, 1}}), black, black, body, world.add_group("end"));
  Rectangle chip;
  chip.width = chip.height = 1e-2;
  chip.place(facing_along({baffled_radius - 1e-3, 0, photodiode}, {-1, 0, 0}));
  SurfaceId const b = world.add_surface(chip, black, black, body, world.add_group("photodiode"));
  world.add_footprint(spot(m, {}, {0, 0, -1}, Profile::point, 0));
  Receiver a_receiver, b_receiver;
  a_receiver.surface = m;
  b_receiver.surface = b;
  if (with_receivers) {
    world.add_receiver("A", a_receiver);
    world.add_receiver("B", b_receiver);
  }
  world.limits.max_order = 6;
  world.limits.route_vertices = 8;
  world.finish();
  return world;
}

// All that receiver gets, or the class of one hit on a ring: longer routes by a ring are resolved by some estimators
// only.
inline SampleMean received_by(TraceResult const& r, std::uint32_t receiver, bool by_ring = false) {
  double mean = 0, variance = 0;
  for (CouplingClass const& c : r.coupling.received) {
    if (c.port.value != receiver) continue;
    if (by_ring && (c.steps.size() != 3 || r.coupling.groups[c.steps[1].group.value] != "rings")) continue;
    mean += c.coupling.mean;
    variance += c.coupling.std_error * c.coupling.std_error;
  }
  return {mean, std::sqrt(variance), (long long)r.total.histories};
}

// Targets at the first hop alone, which leaves the mirror, and no windows.
inline SteeringTables first_hop_only(SteeringTables tables) {
  for (std::size_t i = 0; i < tables.sides.size(); ++i)
    if (tables.strips[i / 2].surface.value != 0) tables.sides[i].alpha = 1;
  tables.level = 0;
  return tables;
}

inline void expect_same(char const* what, SampleMean a, SampleMean b) {
  EXPECT_LT(std::fabs(a.mean - b.mean), 5 * std::hypot(a.std_error, b.std_error)) << what << a.mean << " " << b.mean;
}
inline double relative(SampleMean s) { return s.std_error / s.mean; }

// The BSDF alone, targets at the first hop alone, targets at every hop with weight windows, and waiting for hits
// agree within 5 standard errors; receiver A is known to `goal`.
inline void expect_estimators_agree(std::uint64_t histories, double goal) {
  World world = baffled_tube();
  TraceResult const law = run_histories(world, histories);
  SteeringTables const tables = make_importance(world);
  world.steer(first_hop_only(tables));
  TraceResult const first = run_histories(world, histories);
  world.steer(tables);
  TraceResult const every = run_histories(world, histories);
  for (TraceResult const* r : {&first, &every}) {
    expect_same("A ", received_by(*r, 0), received_by(law, 0));
    expect_same("B ", received_by(*r, 1), received_by(law, 1));
    expect_same("one hit on a ring ", received_by(*r, 0, true), received_by(law, 0, true));
    EXPECT_LT(relative(received_by(*r, 0)), goal);
    EXPECT_TRUE(r->coupling.warnings.empty());
  }
  SampleMean const brute = arrived(world, law, "mirror");  // per power scattered by the spot
  double const emitted = law.total.emitted.sum / double(law.total.histories);
  expect_same("A by waiting ", {brute.mean * emitted, brute.std_error * emitted, brute.n}, received_by(law, 0));
  // what aiming is for: the hidden photodiode, at equal histories (docs/theory/errors.md)
  EXPECT_LT(relative(received_by(every, 1)), relative(received_by(law, 1)) / 3);
  // and what it costs light of one hit, which the dealt first hops find evenly without it
  EXPECT_LT(relative(received_by(every, 0, true)), 1.5 * relative(received_by(law, 0, true)));
}

}  // namespace straytrace::testing
