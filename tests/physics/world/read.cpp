// SPDX-License-Identifier: BSD-3-Clause
// Scene text -> world: the physics that the readers put in between (docs/theory/surfaces.md, eq. 3.19, 6.3, 8.16; case
// B7).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "support/recorded.hpp"
#include "world/model/world.hpp"

namespace straytrace::world_read {
namespace {

World world_of(std::string const& text) {
  FileTexts const texts{{"a.yaml", "straytrace: 1\n" + text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

std::string arm(std::string const& length, double roc_in, double roc_end, double wavelength_nm = 1064) {
  auto const mirror = [](std::string const& name, std::string const& z, int side, double roc) {
    return "  - {name: " + name + ", use: mirror, radius: 40 cm, radius_of_curvature: " + std::to_string(roc) +
           " m, at: [0 m, 0 m, " + z + "], facing: [0, 0, " + std::to_string(side) + "], body: b, material: m}\n";
  };
  return "materials: {m: {scatter: {model: lambertian, tis: 1 ppm}}}\nbodies: {b: {motion: still}}\nscene:\n" +
         mirror("I", "0 m", 1, roc_in) + mirror("E", length, -1, roc_end) +
         "beams: {arm: {cavity: [I, E], wavelength: " + std::to_string(wavelength_nm) +
         " nm}}\nports: {I: {beam: arm, at: I}, E: {beam: arm, at: E}}\n";
}

// Relative deviation of the radii on the two mirrors, in m.
double spot_deviation(World const& w, double in, double end) {
  if (w.footprints().size() != 2) return infinity;
  return std::max(std::fabs(w.footprints()[0].radius / in - 1), std::fabs(w.footprints()[1].radius / end - 1));
}

void expect_spots(World const& w, double in, double end, double tolerance) {
  ASSERT_EQ(w.footprints().size(), 2u);
  EXPECT_LT(testing::deviation(w.footprints()[0].radius, in), tolerance);
  EXPECT_LT(testing::deviation(w.footprints()[1].radius, end), tolerance);
}

// B7: published arms; tolerance 0.5 % of the published digits, here of the derived ones.
TEST(ReadWorld, CavityModesB7) {
  expect_spots(world_of(arm("2999.8 m", 1420, 1683)), 48.65e-3, 58.02e-3, 2e-4);
  expect_spots(world_of(arm("3000 m", 1900, 1900)), 35.30e-3, 35.30e-3, 2e-4);
  expect_spots(world_of(arm("10 km", 5070, 5070)), 120.5e-3, 120.5e-3, 5e-4);
  expect_spots(world_of(arm("10 km", 5580, 5580, 1550)), 89.9e-3, 89.9e-3, 5e-3);
  // controls: mirrors swapped, another wavelength
  EXPECT_GT(spot_deviation(world_of(arm("2999.8 m", 1683, 1420)), 48.65e-3, 58.02e-3), 0.1);
  EXPECT_GT(spot_deviation(world_of(arm("10 km", 5070, 5070, 1550)), 120.5e-3, 120.5e-3), 0.1);
}

// Reflectance of a material at normal incidence, and its BRDF at an angle.
struct Sent {
  double total, brdf;
};
Sent sent_by(std::string const& law, double angle = 0) {
  std::string text = arm("10 km", 5070, 5070);
  std::string const from = "{model: lambertian, tis: 1 ppm}";
  World const world = world_of(text.replace(text.find(from), from.size(), law));
  WorldView const v = world.view();
  Optic const& optic = v.optics[v.surfaces[0].front];
  return {scatter_albedo(v.laws, optic, 1),
          scatter_eval(v.laws, optic, {0, 0, 1}, {std::sin(angle), 0, std::cos(angle)})};
}

TEST(ReadWorld, TotalsAndBrdfs) {  // tolerance 1e-9 for closed forms, 2e-2 where the table of albedos interpolates
  EXPECT_NEAR(sent_by("{model: lambertian, tis: 40 %}").total, 0.4, 1e-9);
  EXPECT_NEAR(sent_by("{model: lambertian, tis: 40 %}", 0.5).brdf, 0.4 / pi, 1e-9);
  EXPECT_NEAR(sent_by("{model: lambertian, brdf: 1e-2 /sr}").total, pi * 1e-2, 1e-9);
  // eq. 3.19: kappa = eps kappa_s/(2 pi), kappa_s fixed by the total; cos(theta) of the projection takes a few per
  // cent.
  double const above = 55e-6, kappa = 5e-6 * statistical_kappa(above) / (2 * pi);
  Sent const s = sent_by("{model: power-law, exponent: 2, tis: 5 ppm, above: 55 urad}", 1e-3);
  EXPECT_NEAR(s.brdf / (kappa / 1e-6), 1, 1e-5);
  EXPECT_NEAR(s.total / 5e-6, 1, 0.12);
  EXPECT_GT(std::fabs(s.brdf / (2 * pi * kappa / 1e-6) - 1), 0.5);  // control: 2 pi forgotten
  // A list adds.
  EXPECT_NEAR(sent_by("[{model: lambertian, tis: 1 %}, {model: lambertian, tis: 2 %}]").total, 0.03, 1e-9);
}

// A model takes the tables of an earlier one with the same value at every key; one that differs in any key has its own.
TEST(ReadWorld, TablesOfModelsWithTheSameValues) {
  auto const check = [](std::string const& one, std::vector<std::string> const& others) {
    Sent const first = sent_by(one, 0.1), twice = sent_by("[" + one + ", " + one + "]", 0.1);
    EXPECT_EQ(twice.total, 2 * first.total) << one;
    EXPECT_EQ(twice.brdf, 2 * first.brdf) << one;
    for (std::string const& other : others) {
      Sent const alone = sent_by(other, 0.1), behind = sent_by("[" + one + ", " + other + "]", 0.1);
      EXPECT_EQ(behind.total, first.total + alone.total) << other;
      EXPECT_EQ(behind.brdf, first.brdf + alone.brdf) << other;
      EXPECT_NE(alone.total, first.total) << other << " has the same total: the test would not see its table";
    }
  };
  check("{model: power-law, tis: 5 ppm, above: 55 urad}",
        {"{model: power-law, tis: 5 ppm, above: 60 urad}", "{model: power-law, tis: 6 ppm, above: 55 urad}",
         "{model: power-law, exponent: 1.5, kappa: 1e-6 /sr, above: 55 urad}"});
  check("{model: harvey, b0: 0.1 /sr, l: 0.01, s: -1.5}",
        {"{model: harvey, b0: 0.1 /sr, l: 0.01, s: -1.5, l_across: 0.02}",
         "{model: harvey, b0: 0.1 /sr, l: 0.01, s: -1.6}", "{model: harvey, b0: 0.2 /sr, l: 0.01, s: -1.5}"});
  check("{model: abg, a: 1e-3 /sr, b: 1e-3, g: 2}", {"{model: abg, a: 1e-3 /sr, b: 2e-3, g: 2}"});
  check("{model: gaussian, width: 0.1, tis: 0.1}", {"{model: gaussian, width: 0.2, tis: 0.1}"});
  check("{model: microfacet, roughness: 0.2, reflectance: 0.3, grazing: 1}",
        {"{model: microfacet, roughness: 0.2, reflectance: 0.3}"});
  check("{model: grooves, across: 0.3, along: 0.02, reflectance: 0.2, lay: around}",
        {"{model: grooves, across: 0.3, along: 0.02, reflectance: 0.2, grazing: 0.5, lay: around}"});
}

// Shadow rule, eq. 8.16: z_i = z_0 ratio^i; the far set mirrors it from the other end.
TEST(ReadWorld, PlacesAndSides) {
  World const world = world_of(
      "params: {q: 1.5}\n"
      "materials: {m: {scatter: {model: lambertian, tis: 1 %}}}\nbodies: {b: {motion: still}}\n"
      "scene:\n"
      "  - {name: n, shape: {disk: {inner_radius: 1 m, outer_radius: 2 m}}, side: back, body: b, material: m, facing: "
      "[0, 0, -1],\n"
      "     repeat: {count: 4, along: z, from: 10 m, ratio: q}}\n"
      "  - {name: f, shape: {disk: {inner_radius: 1 m, outer_radius: 2 m}}, body: b, material: m,\n"
      "     repeat: {count: 4, along: z, origin: 1 km, from: 990 m, ratio: q}}\n"
      "  - {name: t, shape: {cylinder: {radius: 3 m, from: 0 m, to: 1 km}}, side: inner, body: b, material: m}\n"
      "  - {name: d, shape: {disk: {outer_radius: 10 cm}}, body: b, material: m, at: [1 m, 2 m, 3 m],\n"
      "     rotate: {axis: [1, 0, 0], angle: 90 deg}}\n"
      "beams: {s: {on: d, radius: 1 mm}}\nports: {d: {beam: s, at: d}}\n");
  WorldView const v = world.view();
  auto const at = [&](std::uint32_t id) {
    return v.shapes.visit(v.surfaces[id].shape, [](auto const& s) { return s.reference(); });
  };
  auto const facing = [&](std::uint32_t id) {
    return v.shapes.visit(v.surfaces[id].shape, [](auto const& s) { return s.axis; });
  };
  ASSERT_EQ(v.surfaces.size, 10u);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(at(i).z, 10 * std::pow(1.5, i), 1e-12);
    EXPECT_NEAR(at(i + 4).z, 1000 - 10 * std::pow(1.5, i), 1e-10);
    EXPECT_EQ(facing(i).z, -1);
    EXPECT_EQ(facing(i + 4).z, 1);
  }
  auto const scatters = [&](std::uint32_t optic) { return v.optics[optic].laws > 0; };
  EXPECT_TRUE(!scatters(v.surfaces[0].front) && scatters(v.surfaces[0].back));  // side: back
  EXPECT_TRUE(scatters(v.surfaces[4].front) && scatters(v.surfaces[4].back));   // both
  EXPECT_TRUE(!scatters(v.surfaces[8].front) && scatters(v.surfaces[8].back));  // inner: normals point outwards
  EXPECT_GT(dot(v.normal({8}, {3, 0, 5}), Vec3{1, 0, 0}), 0.5);
  EXPECT_NEAR(facing(9).y, -1, 1e-15);  // z turned by 90 degrees about x
  EXPECT_NEAR(at(9).y, 2, 0);
}

}  // namespace
}  // namespace straytrace::world_read
