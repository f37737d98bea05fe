// SPDX-License-Identifier: BSD-3-Clause
// Light below the crossover angle that baffles scatter elsewhere: paths that start and end in it, from a known
// irradiance (docs/theory/wave.md, eq. W.60 to W.62).
#include "trace/deterministic/halo_source.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/gauss_points.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/trace_received.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::testing::halo_source_test {
namespace {

constexpr double tis = 0.3, wavelength = 1.064e-6;

// Two discs that the mirror I lights, a plate that faces both, and around them a wall. Nothing stands between the far
// disc and the plate, or between both discs.
constexpr double near_place = 399.8, far_place = 400, plate_place = 399;           // m
constexpr double near_from = 0.1, near_to = 0.12, far_from = 0.18, far_to = 0.25;  // lit radii
constexpr double plate_from = 0.05, plate_to = 0.09, near_inner = 0.045;
char const* const to_and_fro = "I·S > baffle_far·S > baffle_near·S > baffle_far·S > I·S";

std::string text_of(double crossover_urad) {
  KilometreArm arm =
      kilometre_arm(fmt::format("crossover: {} urad, grid: {{points: 640, window: 0.6 m}}", crossover_urad));
  arm.baffles =
      "  - {name: baffle_far, shape: {disk: {inner_radius: 45 mm, outer_radius: 25 cm}}, at: [0 m, 0 m, 400 m],"
      " facing: [0, 0, -1], body: pipe, material: grey}\n"
      "  - {name: baffle_near, shape: {disk: {inner_radius: 45 mm, outer_radius: 12 cm}}, at: [0 m, 0 m, 399.8 m],"
      " facing: [0, 0, -1], body: pipe, material: grey}\n"
      "  - {name: plate, shape: {disk: {inner_radius: 5 cm, outer_radius: 9 cm}}, at: [0 m, 0 m, 399 m],"
      " facing: [0, 0, 1], body: pipe, material: grey}\n"
      "  - {name: wall, shape: {cylinder: {radius: 26 cm, from: 399.3 m, to: 399.75 m}}, body: pipe, material: grey}\n";
  std::string text = arm.text();
  return text.insert(text.find("  black: {}\n"), "  grey: {scatter: {model: lambertian, tis: 0.3}}\n");
}

World world_of(std::string const& text) {
  FileTexts const texts{{"a.yaml", text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

constexpr double ring = 1e-3;
PolarIrradiance dark() { return {ring, 300, 32, std::vector<float>(300 * 32), std::vector<float>(300 * 32)}; }
template <class Of>
PolarIrradiance irradiance(double from, double to, Of const& of) {
  PolarIrradiance light = dark();
  for (int i = 0; i < light.rings; ++i)
    if (light.radius(i) > from && light.radius(i) < to)
      std::fill_n(light.mean.begin() + i * light.sectors, light.sectors, float(of(light.radius(i))));
  return light;
}
PolarIrradiance even(double mean, double from, double to) {
  return irradiance(from, to, [mean](double) { return mean; });
}

struct Bench {
  World world;
  ArmCavity arm;
  PlaneIrradiance light;
  double share = 0.5;  // of the histories: no result depends on it

  explicit Bench(double crossover_urad = 120)
      : world(world_of(text_of(crossover_urad))), arm(planned_arm(world, world.wave)) {
    light.towards_mirror2.assign(4, dark());
    light.towards_mirror1.assign(4, dark());
    begin_rays_at_crossover(world);
  }
  PolarIrradiance& on_near() { return light.towards_mirror2[1]; }
  PolarIrradiance& on_far() { return light.towards_mirror2[2]; }
  SurfaceId surface(std::string const& name) const {
    for (std::uint32_t i = 0; i < world.surfaces().size(); ++i)
      if (world.name_of({i}) == name) return {i};
    return {};
  }
  TraceResult run(std::uint64_t histories, bool with_source = true) {
    HaloTables tables = halo_source(world, arm, light);
    if (tables.sources.empty()) ADD_FAILURE() << "no light";
    tables.share = share;
    world.light_halo(with_source ? tables : HaloTables{});
    world.finish();
    TraceSettings settings;
    settings.histories = histories;
    settings.threads = 2;
    world.block_size = block_size_of(histories);
    return run_trace(steer(world, 2), settings, *test_backend());
  }
};

// Integral over the azimuth between two coaxial rings at the distance h of cos cos'/d^2; `cosines`: of how many ends.
double exchange(double r1, double r2, double h, int cosines = 2) {
  constexpr int steps = 64;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    double const d2 = r1 * r1 + r2 * r2 + h * h - 2 * r1 * r2 * std::cos((i + 0.5) * 2 * pi / steps);
    sum += std::pow(h * h / d2, 0.5 * cosines) / d2;
  }
  return sum * 2 * pi / steps;
}
template <class Of>
double over(double from, double to, Of const& of) {
  GaussPoints const gauss(12);
  double sum = 0;
  for (std::size_t i = 0; i < gauss.at.size(); ++i)
    sum += gauss.weight[i] * (to - from) * of(from + (to - from) * gauss.at[i]);
  return sum;
}
// Irradiance at the radius r of a disc at the distance h, by the lit ring of the far disc: over its irradiance and its
// albedo.
double lit_by_far(double r, double h, int cosines = 2) {
  return over(far_from, far_to, [&](double at) { return at * exchange(at, r, h, cosines); }) / pi;
}
SampleMean received_by(TraceResult const& r, std::string const& route) {
  for (CouplingClass const& c : r.coupling.received)
    if (received_name(r.coupling, c) == route) return sample_mean(c.coupling, (long long)r.total.histories);
  return {};
}

// Power on a receiver: I rho/pi times the integral of cos cos'/d^2 (eq. W.60). Control: without one cosine.
TEST(HaloSource, LightsReceivers) {
  constexpr double mean = 1;  // so strong that the rays of the mirror do not matter
  Bench bench;
  bench.on_far() = even(mean, far_from, far_to);
  receive_on(bench.world, "plate", bench.surface("plate"));
  SampleMean const power = received_by(bench.run(1 << 18), "I·S > baffle_far·S > plate·D");
  auto const expected = [&](int cosines) {
    double const h = far_place - plate_place;
    return mean * tis * over(plate_from, plate_to, [&](double r) { return 2 * pi * r * lit_by_far(r, h, cosines); });
  };
  expect_mean("power on a plate", power, expected(2), 0.02 * expected(2));
  expect_rejected("without a cosine", power, expected(1));
}

// lambda^2 times the integral of rho/pi E^2 over the back of the near disc, with E the irradiance by the light that
// starts on the far one, which is also that of the light that ends there (eq. W.60, W.61).
TEST(HaloSource, StartsAndEndsOnOneBaffle) {
  constexpr double mean = 1;
  Bench bench;
  bench.share = 0.9;
  bench.on_far() = even(mean, far_from, far_to);
  TraceResult const r = bench.run(1 << 19);
  SampleMean const found = route_coupling(r, to_and_fro);
  auto const expected = [&](int cosines) {
    double const h = far_place - near_place;
    return std::pow(wavelength * mean * tis, 2) * tis / pi * over(near_inner, near_to, [&](double at) {
             return 2 * pi * at * lit_by_far(at, h) * lit_by_far(at, h, cosines);
           });
  };
  expect_mean("two ends in the halo", found, expected(2), 0.06 * expected(2));
  expect_rejected("without a cosine", found, expected(1));
  EXPECT_EQ(find_route(r, to_and_fro)->reverse, 2);
}

// Paths and their reverse couple alike (eq. 1.2): from one baffle in the light to another. Control: more light on one.
TEST(HaloSource, SwapOfTheEndsA25) {
  std::string const there = "I·S > baffle_near·S > wall·S > baffle_far·S > I·S",
                    back = "I·S > baffle_far·S > wall·S > baffle_near·S > I·S";
  auto const traced = [](double near) {
    Bench bench;
    bench.share = 0.9;
    bench.on_near() = even(near, near_from, near_to);
    bench.on_far() = even(0.3, far_from, far_to);
    return bench.run(1 << 19);
  };
  TraceResult const r = traced(2);
  ASSERT_TRUE(find_route(r, there) && find_route(r, back));
  EXPECT_FALSE(find_route(r, there)->by_reverse || find_route(r, back)->by_reverse);
  SampleMean const one = route_coupling(r, there), other = route_coupling(r, back);
  expect_mean("swap", difference(one, other), 0, 0.12 * one.mean);
  expect_rejected("more light", difference(route_coupling(traced(2.5), there), other), 0);
}

// No motion of everything together changes a phase (eq. 2.3, 2.5), and the baffle has its part.
TEST(HaloSource, PhaseSensitivities) {
  Bench bench;
  bench.on_far() = even(1, far_from, far_to);
  TraceResult const r = bench.run(1 << 14);
  ASSERT_TRUE(find_route(r, to_and_fro));
  double const k = 2 * pi / wavelength;
  ASSERT_GT(find_route(r, to_and_fro)->records.size(), 10u);
  for (PathRecord const& record : find_route(r, to_and_fro)->records) {
    std::array<double, 3> sum{};
    double pipe = 0;
    for (PhaseSensitivity const& s : record.phase_sensitivities) {
      for (std::size_t i = 0; i < 3; ++i) sum[i] += s.d[i];
      if (bench.world.bodies()[s.body.value].name == "pipe") pipe = s.d[2];
    }
    for (double const total : sum) EXPECT_NEAR(total, 0, 1e-5 * k);
    EXPECT_NEAR(std::fabs(pipe), 2 * k, 1e-3 * k);  // both discs as one body return the light
    EXPECT_NEAR(record.path_length, 2 * far_place + 0.6, 0.3);
  }
}

// Light straight back to its mirror is that of the classes `halo` (eq. W.21): the routes of one baffle hold what rays
// beyond the crossover angle give, with the source and without it.
TEST(HaloSource, NothingTwice) {
  Bench bench;
  bench.on_far() = even(1, far_from, far_to);
  std::string const once = "I·S > baffle_far·S > I·S";
  bench.share = 0.2;
  TraceResult const with = bench.run(1 << 18), without = bench.run(1 << 18, false);
  SampleMean const rays = route_coupling(without, once);
  expect_mean("straight back", difference(route_coupling(with, once), rays), 0, 0.15 * rays.mean);
  // Control: the light is there, and one of 2 I_L would make the route larger by a factor of 1e5 or so.
  EXPECT_GT(route_coupling(with, to_and_fro).mean, 1e3 * rays.mean);
}

// What starts: the power that meets the baffle and the light that the mirrors scatter beyond the crossover angle.
TEST(HaloSource, EnergyBalance) {
  constexpr double mean = 1e-4;
  Bench bench;
  bench.on_far() = even(mean, far_from, far_to);
  TraceResult const r = bench.run(1 << 17);
  double const power = mean * pi * (far_to * far_to - far_from * far_from),
               beyond = bench.arm.mirrors[0].scattered + bench.arm.mirrors[1].scattered;
  double const emitted = r.total.emitted.sum / double(r.total.histories);  // strata leave it no spread
  EXPECT_LT(deviation(emitted, power + beyond), 1e-4);
  EXPECT_GT(deviation(emitted, beyond), 0.1);  // control
  double sum = 0;
  for (Moments const& column : r.total.energy_balance) sum += column.sum;
  EXPECT_LT(deviation(sum, r.total.emitted.sum), 1e-12);
}

// Mean irradiance at a distance l and a radius by the BSDF 5e-7/theta^2 below the crossover angle (eq. W.17): midpoints
// in equal parts of the power of the spot.
double mean_below(double crossover, double spot, double l, double radius) {
  constexpr int shells = 100, turns = 100;
  double sum = 0;
  for (int i = 0; i < shells; ++i)
    for (int j = 0; j < turns; ++j) {
      double const rho = spot * std::sqrt(-0.5 * std::log((i + 0.5) / shells)), turn = (j + 0.5) * 2 * pi / turns;
      double const bend = rho * (1 / l - 1 / 2500.);
      double const angle = std::hypot(radius / l - bend * std::cos(turn), bend * std::sin(turn));
      if (angle < crossover) sum += 5e-7 / (angle * angle);
    }
  return sum / (shells * turns * l * l);
}

// With the irradiance of the BSDF below the crossover angle (eq. W.17), a receiver has the same light for angles from
// 120 to 240 urad (eq. W.60). Control: the rays alone.
TEST(HaloSource, DoesNotDependOnTheCrossover) {
  auto const at = [](double crossover_urad, bool with_source) {
    Bench bench(crossover_urad);
    bench.share = 0.25;
    double const spot = bench.arm.mirrors[0].spot;
    auto const mean = [&](double l) {
      return [=](double radius) { return mean_below(1e-6 * crossover_urad, spot, l, radius); };
    };
    bench.on_near() = irradiance(0.045, 0.12, mean(near_place));
    bench.on_far() = irradiance(0.12, 0.25, mean(far_place));
    receive_on(bench.world, "plate", bench.surface("plate"));
    return bench.run(1 << 17, with_source);
  };
  SampleMean const first = received(at(120, true));
  expect_mean("170 urad", difference(received(at(170, true)), first), 0, 0.085 * first.mean);
  expect_mean("240 urad", difference(received(at(240, true)), first), 0, 0.085 * first.mean);
  SampleMean const rays = received(at(240, false));
  expect_rejected("rays alone", difference(rays, first), 0);
  EXPECT_LT(rays.mean, 0.8 * first.mean);
}

}  // namespace
}  // namespace straytrace::testing::halo_source_test
