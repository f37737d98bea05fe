// SPDX-License-Identifier: BSD-3-Clause
// Single digs, scratches, glints and chamfers (docs/theory/surfaces.md, eq. 3.32, 3.33; R2.32) of scenes: light
// scattered back into the beam in closed form, places and sizes that are drawn, and which of many is the strongest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/trace_support.hpp"
#include "unit/world/built_scene.hpp"

namespace straytrace::testing::imperfections {
namespace {

constexpr double wavelength = 1.064e-6, w = 0.05;  // m

BuiltScene mirror_with(std::string const& imperfections) {
  return built(R"(straytrace: 1
materials:
  clean: {specular: {reflect: 1}}
  pit: {scatter: {model: lambertian, tis: 1}}
bodies: {optics: {motion: still}}
scene:
  - {name: mirror, shape: {cap: {curvature: 1/(1420 m), outer_radius: 17 cm}}, facing: [0, 0, 1], side: front, body: optics,
     material: clean, imperfections: [)" +
               imperfections + R"(]}
beams: {spot: {on: mirror, radius: 5 cm}}
ports: {mirror: {beam: spot, at: mirror}}
)");
}

double coupled(World const& world, std::uint64_t histories = 4096) {
  double sum = 0;
  for (CouplingClass const& c : run_histories(world, histories).coupling.classes) sum += c.coupling.mean;
  return sum;
}
double intensity(double rho) { return 2 / (pi * w * w) * std::exp(-2 * rho * rho / (w * w)); }

// Eq. 3.32 with eq. 1.4: f = (1/pi) lambda^2 |u|^4 A of a Lambertian dig that scatters all light on its area A.
// Control: the same dig 1 cm farther out.
TEST(Imperfections, dig_scatters_back_in_closed_form) {
  double const area = pi * 100e-6 * 100e-6 / 4;
  auto const expected = [&](double rho) { return wavelength * wavelength * std::pow(intensity(rho), 2) * area / pi; };
  double const found = coupled(mirror_with("{at: [3 cm, 1 cm], diameter: 100 um, material: pit}").world);
  double const rho = std::hypot(0.03, 0.01);
  EXPECT_NEAR(found / expected(rho), 1, 1e-6);
  EXPECT_GT(std::fabs(found / expected(rho + 0.01) - 1), 0.1);
}

// All ways to state a size agree: diameter, area, grade of ISO 10110-7 (root of the area), dig number (10 um).
TEST(Imperfections, sizes) {
  double const d = 100e-6, area = pi * d * d / 4;
  double const one = coupled(mirror_with("{at: [1 cm, 0 cm], diameter: 100 um, material: pit}").world);
  for (std::string const& size : {std::string("dig: 10"), "area: " + std::to_string(1e12 * area) + " um^2",
                                  "grade: " + std::to_string(1e6 * std::sqrt(area)) + " um"})
    EXPECT_NEAR(coupled(mirror_with("{at: [1 cm, 0 cm], material: pit, " + size + "}").world) / one, 1, 1e-5) << size;
  double const other = coupled(mirror_with("{at: [1 cm, 0 cm], dig: 11, material: pit}").world);
  EXPECT_NEAR(other / one, 1.21, 1e-5);  // control
}

// A scratch is a row of pieces: integral of |u|^4 along it, sixteen midpoints. Control: its middle alone.
TEST(Imperfections, scratch_is_integrated_along_its_length) {
  double const width = 5e-6;
  double integral = 0;
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) integral += std::pow(intensity(0.06 * (i + 0.5) / steps), 2) * 0.06 / steps;
  double const found =
      coupled(mirror_with("{scratch: [[0 cm, 0 cm], [6 cm, 0 cm]], width: 5 um, material: pit}").world, 1 << 16);
  EXPECT_NEAR(found / (wavelength * wavelength * integral * width / pi), 1, 3e-3);
  EXPECT_GT(std::fabs(std::pow(intensity(0.03), 2) * 0.06 / integral - 1), 0.1);
}

// Eq. 3.33: a facet square to the light returns R (|u|^2 A)^2, a small mirror; tilted by delta, it reflects 2 delta
// away. Control: a Lambertian disc of the same reflectance, and no tilt.
TEST(Imperfections, glint_is_a_small_mirror) {
  double const diameter = 100e-6, area = pi * diameter * diameter / 4, reflectance = 0.04, tilt = 1e-3;
  std::string const place = "{at: [0 cm, 0 cm], diameter: 100 um, ";
  double const square = coupled(mirror_with(place + "facet: 4 %}").world),
               tilted = coupled(mirror_with(place + "facet: 4 %, tilt: [0 mrad, 1 mrad]}").world),
               expected = reflectance * std::pow(intensity(0) * area, 2),
               away = std::exp(-pi * area * std::pow(2 * tilt / wavelength, 2));
  EXPECT_NEAR(square / expected, 1, 1e-4);
  EXPECT_NEAR(tilted / square / away, 1, 1e-3);
  EXPECT_LT(away, 0.99);
  EXPECT_GT(square / (reflectance * coupled(mirror_with(place + "material: pit}").world)), 1e3);
}

// Tilts that are drawn have the stated standard deviation.
TEST(Imperfections, drawn_tilts) {
  std::string const drawn = "{count: 460, diameter: 20 um, within: 10 cm, facet: 4 %";
  World const flat = mirror_with(drawn + "}").world, tilted = mirror_with(drawn + ", spread: 20 mrad}").world;
  Sampler square;
  for (std::size_t i = 0; i < tilted.surfaces().size(); ++i) {
    auto const facing = [&](World const& w) {
      return w.view().normal({std::uint32_t(i)},
                             w.view().shapes.visit(w.surfaces()[i].shape, [](auto const& s) { return s.reference(); }),
                             0);
    };
    if (tilted.name_of({std::uint32_t(i)}).find("glint") == std::string::npos) continue;
    Vec3 const change = facing(tilted) - facing(flat);
    square.add(change.x * change.x / 4e-4);
    square.add(change.y * change.y / 4e-4);
  }
  expect_mean("square of the tilt over its variance", square.mean(), 1, 0.6);
  expect_rejected("the same, of both axes together", square.mean(), 2);
}

// The chamfer of a disc in an even beam: |u|^2 at its radius, on the area of the cone, at 45 degrees to the light. A
// Lambertian returns (1/pi) cos^2, since light and view are both slanted (eq. 1.1).
TEST(Imperfections, chamfer_of_an_edge) {
  double const width = 1e-3, radius = 0.17 - width / 2, area = 2 * pi * radius * width * std::sqrt(2.0);
  double const found = coupled(mirror_with("{chamfer: 1 mm, material: pit}").world, 1 << 16),
               flat = coupled(mirror_with("{chamfer: 1 mm, angle: 0 deg, material: pit}").world, 1 << 16),
               expected = wavelength * wavelength * std::pow(intensity(radius), 2) * area / pi / 2;
  EXPECT_NEAR(found / expected, 1, 0.05);
  EXPECT_NEAR(found / flat, 1 / std::sqrt(2.0), 0.02);
}

// Straight back a glint is one vertex, its own reverse, and moves by 2k along the light (eq. 2.2).
TEST(Imperfections, one_vertex_moves_by_twice_the_wave_number) {
  CouplingTable const table =
      run_histories(mirror_with("{at: [0 cm, 0 cm], diameter: 50 um, facet: 4 %}").world, 1024).coupling;
  ASSERT_EQ(table.classes.size(), 1u);
  CouplingClass const& glint = table.classes.front();
  EXPECT_EQ(glint.steps.size(), 1u);
  EXPECT_EQ(glint.reverse, 1);
  ASSERT_FALSE(glint.records.empty());
  ASSERT_EQ(glint.records.front().phase_sensitivities.size(), 1u);
  EXPECT_NEAR(std::fabs(glint.records.front().phase_sensitivities.front().d[2]) / (4 * pi / wavelength), 1, 1e-9);
}

// Drawn imperfections: the same for the same seed, uniform over the disc, diameters with N(>d) ~ d^-2 in their range;
// the note names the one in most light.
TEST(Imperfections, drawn_from_a_distribution) {
  std::string const drawn = "{count: 200, diameter: [10 um, 100 um], within: 10 cm, material: pit, seed: ";
  BuiltScene const one = mirror_with(drawn + "1}"), same = mirror_with(drawn + "1}"), other = mirror_with(drawn + "2}");
  EXPECT_EQ(one.world.fingerprint(), same.world.fingerprint());
  EXPECT_NE(one.world.fingerprint(), other.world.fingerprint());
  Sampler square, small;
  double most = 0;
  std::string strongest;
  for (Footprint const& f : one.world.footprints()) {
    if (f.profile != Profile::even) continue;
    double const rho2 = f.centre.x * f.centre.x + f.centre.y * f.centre.y;
    square.add(rho2 / 0.01);
    small.add(2 * f.radius < 20e-6);
    EXPECT_GE(2 * f.radius, 10e-6 * (1 - 1e-9));
    EXPECT_LE(2 * f.radius, 100e-6 * (1 + 1e-9));
    if (f.share > most) most = f.share, strongest = one.world.name_of(f.surface);
  }
  expect_mean("square of the radius", square.mean(), 0.5, 0.2);
  double const a = std::pow(10.0, -2), b = std::pow(100.0, -2);
  expect_mean("smaller than 20 um", small.mean(), (a - std::pow(20.0, -2)) / (a - b), 0.25);
  expect_rejected("smaller than 20 um, even in log d", small.mean(), std::log(2.0) / std::log(10.0));
  std::string const notes = std::accumulate(one.world.notes.begin(), one.world.notes.end(), std::string());
  EXPECT_NE(notes.find("'" + strongest + "' receives most light"), std::string::npos) << notes;
}

// Each imperfection is a route of its own, named after it; among many, one can dominate.
TEST(Imperfections, routes_name_the_strongest) {
  World const world = mirror_with(
                          "{at: [0 cm, 0 cm], diameter: 300 um, name: pit, material: pit}, "
                          "{at: [2 cm, 0 cm], diameter: 20 um, material: pit}, "
                          "{at: [4 cm, 0 cm], diameter: 20 um, material: pit}")
                          .world;
  CouplingTable const table = run_histories(world, 4096).coupling;
  ASSERT_GE(table.classes.size(), 3u);  // and between them, at grazing angles
  double most = 0, sum = 0;
  std::string name;
  for (CouplingClass const& c : table.classes) {
    sum += c.coupling.mean;
    if (c.coupling.mean > most) most = c.coupling.mean, name = route_name(table, c);
  }
  EXPECT_NE(name.find("mirror/pit_1"), std::string::npos) << name;
  EXPECT_GT(most, 0.99 * sum);
}

// On a mirror of a cavity light scattered straight back is the mode itself: no route; a baffle makes one. Control: a
// beam that is no cavity.
TEST(Imperfections, mirror_of_a_cavity) {
  std::string const scene = R"(straytrace: 1
materials:
  clean: {specular: {reflect: 1}}
  pit: {scatter: {model: lambertian, tis: 1}}
  steel: {scatter: {model: lambertian, tis: 10 %}}
bodies: {one: {motion: still}, two: {motion: still}, tube: {motion: still}}
scene:
  - {name: ITM, shape: {cap: {curvature: 1/(1420 m), outer_radius: 17 cm}}, facing: [0, 0, 1], side: front, body: one,
     material: clean, imperfections: [{at: [1 mm, 0 mm], diameter: 100 um, material: pit}]}
  - {name: ETM, shape: {cap: {curvature: 1/(1683 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 3 km], facing: [0, 0, -1],
     side: front, body: two, material: clean}
BAFFLE
beams: {arm: {cavity: [ITM, ETM]}}
ports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}
)";
  auto const with = [&](std::string const& baffle) {
    std::string text = scene;
    text.replace(text.find("BAFFLE"), 6, baffle);
    return built(text).world;
  };
  EXPECT_EQ(run_histories(with(""), 4096).coupling.classes.size(), 0u);
  World const world =
      with(R"(  - {name: baffle, shape: {disk: {inner_radius: 30 cm, outer_radius: 50 cm}}, at: [0 m, 0 m, 1 m],
     facing: [0, 0, -1], side: front, body: tube, material: steel})");
  CouplingTable const table = run_histories(world, 1 << 18).coupling;
  auto const row = std::ranges::find_if(table.classes, [&](auto const& k) {
    return route_name(table, k).starts_with("ITM/dig_1·S > baffle·S > ITM/dig_1");
  });
  ASSERT_NE(row, table.classes.end());
  CouplingClass const& c = *row;
  // dig > baffle > dig: share s = |u|^2 A, baffle at L = 1 m, beta (1/pi)^2 lambda^2 s times the integral of
  Footprint const* dig = nullptr;
  for (Footprint const& f : world.footprints())
    if (f.profile == Profile::even) dig = &f;
  ASSERT_TRUE(dig);
  double const s = dig->share;
  double const inner = std::pow(1 / std::hypot(1, 0.3), 2), outer = std::pow(1 / std::hypot(1, 0.5), 2);
  // cos^4/l^4 over it, (pi/(3 L^2)) [cos^6] with cos^2 = L^2/(L^2 + r^2)
  double const geometry = pi / 3 * (std::pow(inner, 3) - std::pow(outer, 3));
  double const expected = s * (1 / pi) * (0.1 / pi) * (1 / pi) * wavelength * wavelength * s * geometry;
  EXPECT_NEAR(c.coupling.mean / expected, 1, 5 * c.coupling.std_error / c.coupling.mean + 1e-3);
}

}  // namespace
}  // namespace straytrace::testing::imperfections
