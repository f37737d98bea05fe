// SPDX-License-Identifier: BSD-3-Clause
// Light through glass: plates and ghosts (docs/theory/sampling.md, docs/theory/surfaces.md, eq. 3.25), plates in
// contact (R3.23), absorption, and receivers that are only seen through glass (docs/theory/sampling.md).
#include <gtest/gtest.h>

#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing::trace_glass {
namespace {

// A thin beam along z from the origin, and a photodiode at z = 1 m.
World beam_and_photodiode() {
  World world;
  std::uint32_t const black = black_optic(world);
  Footprint const beam = free_beam(world.add_group("laser"), {}, {0, 0, 1}, Profile::even, 1e-3);
  SurfaceId const end = world.add_surface(disk(0, 0.4, {{0, 0, 1}, {0, 0, -1}}), black, black,
                                          world.add_body("photodiode", {}), world.add_group("photodiode"));
  world.add_footprint(beam);
  Receiver r;
  r.surface = end;
  world.add_receiver("photodiode", r);
  world.limits.max_order = 40;
  world.limits.route_vertices = 8;
  world.limits.roulette_below = 0;
  return world;
}
SampleMean received(TraceResult const& r, std::string const& route = {}) {
  double mean = 0, variance = 0;
  for (CouplingClass const& c : r.coupling.received) {
    if (!route.empty() && route_name(r.coupling, c) != route) continue;
    mean += c.coupling.mean;
    variance += c.coupling.std_error * c.coupling.std_error;
  }
  return {mean, std::sqrt(variance), (long long)r.total.histories};
}

SampleMean ratio(SampleMean a, SampleMean b) {
  double const mean = a.mean / b.mean;
  return {mean, mean * std::hypot(a.std_error / a.mean, b.std_error / b.mean), a.n};
}

TEST(Glass, LosslessPlateAndItsGhostScene7) {
  World world = beam_and_photodiode();
  add_plate(world, "plate", 1.5, 0.1, 0.11);
  world.finish();
  TraceResult const r = run_histories(world, 1 << 18);
  expect_mean("plate, (1 - R)/(1 + R)", received(r), 0.923077, 6e-3);
  expect_mean("ghost, T^2 R^2",
              received(r, "laser·B > plate below·T > plate above·R > plate below·R > plate above·T > photodiode·D"),
              1.4746e-3, 7e-4);
  expect_rejected("one face only, 1 - R", received(r), 0.96);
  double sum = 0;
  for (Moments const& column : r.total.energy_balance) sum += column.sum;
  EXPECT_NEAR(sum / r.total.emitted.sum, 1, 1e-12);
}

TEST(Glass, AbsorptionBeerLambert) {
  World world = beam_and_photodiode();
  add_plate(world, "plate", 1.0, 0.1, 0.3, 0, 0.5, 2.0);
  world.finish();
  TraceResult const r = run_histories(world, 1 << 16);
  EXPECT_NEAR(received(r).mean, std::exp(-2.0 * 0.2), 1e-12);
  double const n = double(r.total.histories);  // R2.24: what each object absorbs
  for (std::size_t i = 0; i < r.coupling.groups.size(); ++i)
    EXPECT_NEAR(r.total.absorbed[i].sum / n, r.coupling.groups[i] == "photodiode" ? std::exp(-0.4) : 0, 1e-12);
  EXPECT_NEAR(r.total.absorbed.back().sum / n, 1 - std::exp(-0.4), 1e-12);
  EXPECT_GT(std::fabs(r.total.absorbed.back().sum / n - (1 - std::exp(-0.8))), 0.1);  // control: the way counted twice
}

// A plate with a white back face, and a measuring plane inside it that looks at one side. What arrives there on its
// own, and what is connected to it, has lost exp(-a d) on the way.
SampleMean inside_the_plate(double absorption, bool on_the_way_back) {
  World world = beam_and_photodiode();
  BodyId const body = world.add_body("plate", {});
  std::uint32_t const volume = world.add_volume({1.0, absorption}), open = glass_optic(world);
  world.add_surface(disk(0, 0.5, {{0, 0, 0.1}, {0, 0, -1}}), open, open, body, world.add_group("below"), volume);
  world.add_surface(disk(0, 0.5, {{0, 0, 0.3}, {0, 0, 1}}), black_optic(world), lambertian_optic(world, 0.8), body,
                    world.add_group("above"), volume);
  Receiver plane;
  plane.surface = world.add_surface(disk(0, on_the_way_back ? 5e-3 : 0.4, {{0, 0, 0.2}, {0, 0, 1}}), open, open, body,
                                    world.add_group("plane"));
  plane.clear = true;
  plane.front = on_the_way_back;
  plane.back = !on_the_way_back;
  world.add_receiver("plane", plane);
  world.limits.max_order = 3;
  world.finish();
  TraceResult const r = run_histories(world, 1 << 15);
  Estimate const e = r.coupling.received_power[1];
  return {e.mean, e.std_error, 1 << 15};
}

TEST(Glass, ReceiversInsideAnAbsorberBeerLambert) {
  double const a = 5;
  EXPECT_NEAR(inside_the_plate(a, false).mean / inside_the_plate(0, false).mean, std::exp(-a * 0.1), 1e-9);
  SampleMean const back = ratio(inside_the_plate(a, true), inside_the_plate(0, true));
  // The way back, of 0.1 m, is longer by rho^2/(2 d), with rho^2 the sum of those of a spot of 1 mm and a plane of 5
  // mm.
  double const slant = 0.5 * (1e-3 * 1e-3 + 5e-3 * 5e-3) / (2 * 0.1);
  expect_mean("there and back", back, std::exp(-a * (0.3 + slant)), 1e-3);
  expect_rejected("as if all came straight back", back, std::exp(-a * 0.3));
  expect_rejected("the way back for nothing", back, std::exp(-a * 0.2));
}

// Two plates that touch are one plate; 20 nm apart they are two (incoherent sum: (1 - R)/(1 + 3 R)).
TEST(Glass, TouchingPlatesR3_23) {
  for (double const gap : {0.0, 2e-8}) {
    World world = beam_and_photodiode();
    add_plate(world, "first", 1.5, 0.1, 0.11);
    add_plate(world, "second", 1.5, 0.11 + gap, 0.12);
    world.finish();
    SampleMean const all = received(run_histories(world, 1 << 18));
    expect_mean("touching or apart", all, gap == 0 ? 0.96 / 1.04 : 0.96 / 1.12, 8e-3);
    expect_rejected("the other one", all, gap == 0 ? 0.96 / 1.12 : 0.96 / 1.04);
  }
}

// A lit diffuse plate, a diffuse screen above it, and a small photodiode next to the plate that faces the screen.
World seen_through(double index, double radius, bool covered) {
  World world;
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  BodyId const body = world.add_body("all", {});
  SurfaceId const plate =
      world.add_surface(disk(0, 0.05, {{}, {0, 0, 1}}), white, black, body, world.add_group("target"));
  world.add_surface(disk(0, 0.4, {{0, 0, 1}, {0, 0, -1}}), white, black, body, world.add_group("screen"));
  SurfaceId const chip =
      world.add_surface(disk(0, radius, {{0.4, 0, 0}, {0, 0, 1}}), black, black, body, world.add_group("photodiode"));
  if (index > 0) add_plate(world, "window", index, 0.05, 0.06, 0.4, 0.1);  // too small to mirror the target
  world.add_footprint(spot(plate, {}, {0, 0, -1}, Profile::gaussian, 0.01));
  Receiver r;
  r.surface = chip;
  world.add_receiver("photodiode", r);
  world.limits.max_order = 12;
  world.limits.roulette_below = 0;
  world.finish();
  if (covered) find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].behind_glass, covered && index > 0);
  return world;
}

TEST(Glass, PhotodiodeBehindAWindow) {
  SampleMean const bare = received(run_histories(seen_through(0, 1e-3, true), 1 << 18));
  SampleMean const empty = received(run_histories(seen_through(1.0, 1e-3, true), 1 << 18));
  expect_mean("a window of index 1 is no window", ratio(empty, bare), 1, 6e-2);
  double transmitted = 0;  // all inner reflections, at the angle of the centre of the screen
  double const cos_i = 1 / std::sqrt(1.16);
  Amplitudes const a = Fresnel{}.amplitudes(cos_i, 1, 1.5, true);
  for (double const r : {norm(a.rs), norm(a.rp)}) transmitted += 0.5 * (1 - r) / (1 + r);
  SampleMean const glass = received(run_histories(seen_through(1.5, 1e-3, true), 1 << 18));
  expect_mean("window, (1 - R)/(1 + R)", ratio(glass, bare), transmitted, 6e-2);
  expect_rejected("no window", ratio(glass, bare), 1);
}

// A lit white plate, a thin glass window without reflection, and a photodiode that sees the plate through it alone:
// irradiance = pi L sin^2 for a small photodiode on the axis of an even disc of radiance L = rho / (pi A).
World lit_behind_a_window(double scatter, bool mirror, bool covered, double radius = 1e-3, bool both = false) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), white = lambertian_optic(world, scatter);
  Optic optic;
  optic.laws = 1;
  optic.law[0] = world.add_law(Lambertian{scatter});
  optic.reflect = mirror ? 1 - scatter : 0;
  SurfaceId const lamp = world.add_surface(disk(0, 0.1, {{}, {0, 0, 1}}), mirror ? world.add_optic(optic) : white,
                                           black, body, world.add_group("lamp"));
  SurfaceId const chip =
      world.add_surface(disk(0, radius, {{0, 0, 0.2}, {0, 0, -1}}), black, black, body, world.add_group("photodiode"));
  add_plate(world, "window", 1.0, 0.1, 0.11);
  world.add_footprint(spot(lamp, {}, {0, 0, -1}, Profile::even, 0.1));
  // meets nothing: half of the histories start with it
  world.add_footprint(free_beam(world.add_group("laser"), {5, 0, 0}, {1, 0, 0}, Profile::even, 1e-3, 0, 1));
  Receiver r;
  r.surface = chip;
  r.back = both;
  world.add_receiver("photodiode", r);
  world.limits.max_order = 5;
  world.finish();
  if (covered) find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].behind_glass, covered);
  return world;
}

TEST(Glass, LightThroughAWindow) {
  double const sine2 = 0.01 / (0.01 + 0.04), expected = 0.5 * (1e-6 / 0.01) * sine2;  // rho A_pd / A_lamp sin^2
  SampleMean const seen = received(run_histories(lit_behind_a_window(0.5, false, true), 1 << 18));
  expect_mean("white plate", seen, expected, 0.04 * expected);
  expect_rejected("half the histories", seen, 0.5 * expected);
  SampleMean const either = received(run_histories(lit_behind_a_window(0.5, false, true, 1e-3, true), 1 << 18));
  expect_mean("a photodiode that counts both sides", either, expected, 0.06 * expected);
  // a mirror that scatters 1e-5: the sub-path continues, and the surfaces before still count
  SampleMean const faint = received(run_histories(lit_behind_a_window(1e-5, true, true), 1 << 18));
  expect_mean("mirror", faint, 2e-5 * expected, 2e-5 * 0.04 * expected);
}

// A wide photodiode is met by the walk as often as by sub-paths: weighed, they make one mean.
TEST(Glass, LightThroughAWindowIsNotCountedTwice) {
  double const radius = 0.09, gap = 0.2, big = 0.1, s = 1 + (gap * gap + radius * radius) / (big * big);
  double const factor =
      0.5 * (s - std::sqrt(s * s - 4 * radius * radius / (big * big)));  // coaxial discs, lamp to chip
  auto const watts = [&](bool covered) {
    World world = lit_behind_a_window(0.5, false, covered, radius);
    return received(run_histories(world, 1 << 17));
  };
  for (bool const covered : {true, false}) {
    expect_mean("view factor", watts(covered), 0.5 * factor, (covered ? 0.02 : 0.05) * factor);
    expect_rejected("twice", watts(covered), factor);
  }
}

// The walk alone, and the walk weighed against sub-paths, on a photodiode large enough for both.
TEST(Glass, SubPathsShareWithTheWalk) {
  SampleMean const walk = received(run_histories(seen_through(1.5, 0.1, false), 1 << 20));
  SampleMean const both = received(run_histories(seen_through(1.5, 0.1, true), 1 << 18));
  expect_mean("both techniques", ratio(both, walk), 1, 0.3);
  EXPECT_LT(both.std_error, walk.std_error / 3);
}

}  // namespace
}  // namespace straytrace::testing::trace_glass
