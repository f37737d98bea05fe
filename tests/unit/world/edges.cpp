// SPDX-License-Identifier: BSD-3-Clause
// The table `edges`, and the rims that beams pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/message_of.hpp"
#include "unit/world/built_scene.hpp"
#include "world/ghosts/apertures.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

constexpr char arm[] =
    "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 1 ppm}}, black: {}}\n"
    "bodies: {b: {motion: still}}\nscene:\n"
    "  - {name: I, use: mirror, radius: 17 cm, radius_of_curvature: 1420 m, at: [0 m, 0 m, 0 m], facing: [0, 0, 1],"
    " body: b, material: m}\n"
    "  - {name: E, use: mirror, radius: 17 cm, radius_of_curvature: 1683 m, at: [0 m, 0 m, 3000 m], facing: [0, 0, -1],"
    " body: b, material: m}\n"
    "  - {name: ring_one, shape: {disk: {inner_radius: 15 cm, outer_radius: 50 cm}}, at: [3 mm, 4 mm, 1000 m],"
    " facing: [0, 0, 1], body: b, material: black}\n"
    "  - {name: ring_two, shape: {cone: {inner_radius: 40 cm, outer_radius: 50 cm, half_angle: 45 deg}},"
    " at: [0 m, 0 m, 2000 m], facing: [0, 0, 1], body: b, material: black}\n"
    "  - {name: wall, shape: {cylinder: {radius: 60 cm, from: 1 m, to: 2999 m}}, body: b, material: black}\n"
    "beams: {arm: {cavity: [I, E]}}\nports: {I: {beam: arm, at: I}, E: {beam: arm, at: E}}\n";

World world_of(std::string const& more, std::string const& before = arm) { return testing::built(before + more).world; }
std::string complaint(std::string const& more, std::string const& before = arm) {
  return test::message_of([&] { world_of(more, before); });
}

TEST(ReadEdges, ReadsTheKeys) {
  World const w = world_of(
      "edges: {surfaces: \"ring*\", offset: [1 mm, 0 mm, 0 mm], tooth_height: 6 mm, tooth_width: 1 cm, sum: "
      "in-phase}\n");
  EXPECT_EQ(w.edges.groups, (std::vector<std::string>{"ring_one", "ring_two"}));
  EXPECT_EQ(w.edges.offset.x, 1e-3);
  EXPECT_EQ(w.edges.tooth_height, 6e-3);
  EXPECT_EQ(w.edges.tooth_width, 1e-2);
  EXPECT_EQ(w.edges.sum, EdgeSettings::Sum::in_phase);
  EXPECT_EQ(world_of("edges: {surfaces: [ring_two, ring_two]}\n").edges.groups.size(), 1u);
  EXPECT_TRUE(world_of("").edges.groups.empty());
  // Edges are independent of the trace: the same histories are valid with others.
  EXPECT_EQ(w.fingerprint(), world_of("").fingerprint());
}

TEST(ReadEdges, ErrorsAreExplained) {
  EXPECT_THAT(complaint("edges: {surfaces: wall}\n"), HasSubstr("'wall' has no inner edge"));
  EXPECT_THAT(complaint("edges: {surfaces: wall}\n"), HasSubstr("ring_one, ring_two"));
  EXPECT_THAT(complaint("edges: {surfaces: ring_ome}\n"), HasSubstr("did you mean 'ring_one'?"));
  EXPECT_THAT(complaint("edges: {offset: [1 mm, 0 m, 0 m]}\n"), HasSubstr("'edges' names no surfaces"));
  EXPECT_THAT(complaint("edges: {surfaces: ring_one, tooth_height: 6 mm}\n"), HasSubstr("tooth_width"));
  EXPECT_THAT(complaint("edges: {surfaces: ring_one, tooth_width: 6 mm}\n"), HasSubstr("without 'tooth_height'"));
  for (char const* key : {"tooth_height: 15 cm, tooth_width: 1 cm", "tooth_height: 1 cm, tooth_width: 95 cm",
                          "offset: [0 m, 15 cm, 0 m]"})
    EXPECT_THAT(complaint(std::string("edges: {surfaces: \"ring*\", ") + key + "}\n"),
                HasSubstr("is too large for an edge of radius 0.15 m"));
  EXPECT_EQ(complaint("edges: {surfaces: \"ring*\", tooth_height: 14 cm, tooth_width: 94 cm}\n"), "no error");
  EXPECT_THAT(complaint("edges: {surfaces: ring_one, sum: coherent}\n"), HasSubstr("independent"));
  EXPECT_THAT(complaint("edges: {surfaces: ring_one, offset: 1 mm}\n"), HasSubstr("error"));
  EXPECT_THAT(complaint("edges: {surfaces: ring_one, spread: 1 mm}\n"), HasSubstr("spread"));
  std::string spot = arm;
  spot = spot.substr(0, spot.find("beams:")) + "beams: {arm: {on: I, radius: 5 cm}}\nports: {I: {beam: arm, at: I}}\n";
  EXPECT_THAT(complaint("edges: {surfaces: ring_one}\n", spot), HasSubstr("no beam is the mode of a cavity"));
}

TEST(InnerRim, OfTheShapesThatHaveOne) {
  World const w = world_of("");
  std::vector<double> radii;
  for (std::uint32_t id = 0; id < w.surfaces().size(); ++id)
    if (auto const rim = rim_of(w, {id})) {
      radii.push_back(rim->radius);
      EXPECT_NEAR(length(rim_point(*rim, 1.0) - rim->centre), rim->radius, 1e-12);
      EXPECT_NEAR(dot(rim_point(*rim, 1.0) - rim->centre, rim->axis), 0, 1e-12);
    }
  EXPECT_EQ(radii, (std::vector<double>{0.15, 0.40}));
}

TEST(InnerRim, GoesUpAndDownTheTeeth) {
  World w;
  SerratedCone cone;
  cone.inner_radius = 0.4;
  cone.outer_radius = 0.5;
  cone.half_angle = pi / 6;
  cone.tooth_depth = 0.02;
  cone.teeth = 50;
  cone.phase = 0.3;
  cone.place({{0, 0, 7}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  BodyId const body = w.add_body("b", {});
  std::uint32_t const black = w.add_optic({});
  InnerRim const rim = *rim_of(w, w.add_surface(cone, black, black, body, w.add_group("cone")));
  for (double azimuth = 0; azimuth < 6.28; azimuth += 0.01) {
    Vec3 const p = rim_point(rim, azimuth);
    EXPECT_NEAR(std::hypot(p.x, p.y), cone.rim(p - dot(p, cone.axis) * cone.axis), 1e-12);
    EXPECT_NEAR(length(cone.project(p) - p), 0, 1e-12);  // on the cone
  }
  EXPECT_NEAR(rim_radius(rim, 0.3), 0.4, 1e-12);
  EXPECT_NEAR(rim_radius(rim, 0.3 + pi / 50), 0.42, 1e-12);
}

// The mode of the cavity at the rims (eq. 6.1), both mirrors included.
TEST(BeamApertures, OfACavity) {
  World const w = world_of("");
  std::vector<BeamAperture> const all = apertures_of(w);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_TRUE(all[0].reflected && all[3].reflected && !all[1].reflected);
  EXPECT_NEAR(all[0].at.curvature, -1.0 / 1420, 1e-9);  // what the mirror reflects converges
  EXPECT_NEAR(all[0].at.w, 48.68e-3, 1e-5);
  EXPECT_NEAR(all[3].at.w, 58.05e-3, 1e-5);
  EXPECT_NEAR(all[1].along, 1000, 1e-9);
  EXPECT_NEAR(all[1].opening.x, 5e-3, 1e-12);
  double const waist = 9.682e-3, from_waist = 1000 - 1363.82, rayleigh = pi * waist * waist / 1064e-9;
  EXPECT_NEAR(all[1].at.w / (waist * std::hypot(1, from_waist / rayleigh)), 1, 1e-3);
  EXPECT_NEAR(all[1].at.curvature * (from_waist + rayleigh * rayleigh / from_waist), 1, 1e-3);
  EXPECT_NEAR(clipped_share(all[0].at, all[0].opening) / std::exp(-2 * std::pow(0.17 / all[0].at.w, 2)), 1, 1e-9);
}

}  // namespace
}  // namespace straytrace::testing
