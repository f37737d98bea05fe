// SPDX-License-Identifier: BSD-3-Clause
// Glass of the parts that come with the program, and the warnings where glass has no effect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/files/read_write.hpp"
#include "scene/model_tree.hpp"
#include "support/ghost_support.hpp"
#include "support/message_of.hpp"
#include "unit/world/built_scene.hpp"

namespace straytrace::world_glass {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char head[] =
    "straytrace: 1\ninclude: [library/parts.yaml]\nmaterials:\n  clear: {specular: {reflect: 100 ppm, transmit: 1 - "
    "150 "
    "ppm}}\n"
    "  hr: {specular: {reflect: 1 - 5 ppm, transmit: 4 ppm}}\n  white: {scatter: {model: lambertian, tis: 10 %}}\n"
    "  black: {}\nbodies: {b: {motion: still}}\n";

testing::BuiltScene with_library(std::string const& text) {
  FileTexts texts{{"a.yaml", text}};
  for (EmbeddedFile const& file : embedded_files())
    if (is_library(file.name)) texts[std::string(file.name)] = file.text;
  return testing::built(texts);
}
// `entries` of the scene, a screen at z = 1 m behind them, and a probe beam along z from -1 m.
testing::BuiltScene read(std::string const& entries, std::string const& more = "", std::string const& lit = "") {
  return with_library(head + more + "scene:\n" + entries +
                      "  - {name: screen, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: "
                      "[0, 0, -1], body: b, material: white}\n"
                      "beams: {probe: {from: [0 m, 0 m, -1 m], facing: [0, 0, 1], radius: 1 mm" +
                      lit + "}}\nreceivers: {r: {on: screen}}\n");
}
std::string entry(std::string const& words) { return "  - {name: x, facing: [0, 0, -1], body: b, " + words + "}\n"; }

double index_of(World const& world) {  // of what fills the first surface; 0: nothing
  std::uint32_t const volume = world.surfaces()[0].volume;
  return volume == Surface::none ? 0 : world.view().media[world.view().volumes[volume].medium].index;
}

TEST(Glass, PartsThatLetLightInAreFilled) {
  for (std::string const part : {"lens", "thick_mirror", "plate", "mounted_lens", "viewport", "test_mass"}) {
    EXPECT_NEAR(index_of(read(entry("use: " + part + ", material: clear")).world), 1.44963, 1e-5) << part;
    EXPECT_NEAR(index_of(read(entry("use: " + part + ", material: clear, medium: bk7")).world), 1.50663, 1e-5) << part;
    EXPECT_EQ(index_of(read(entry("use: " + part + ", material: clear, medium: none")).world), 0) << part;
  }
  for (std::string const part : {"lens", "thick_mirror", "plate", "test_mass"})
    EXPECT_EQ(index_of(read(entry("use: " + part + ", material: white")).world), 0) << part;
  EXPECT_EQ(index_of(read(entry("use: flat_mirror, material: white")).world), 0);
}

// Light that arrives on the screen, and its optical path: 2 m and (n - 1) 6 mm. Controls: no glass; a window of steel.
TEST(Glass, ViewportLetsLightThroughAndRefracts) {
  auto const arrives = [](std::string const& words) {
    World const world = read(entry(words)).world;
    BeamSpot at;
    for (BeamSpot const& s : testing::beam_spots(world, launches(world).front(), {}))
      if (s.order == 0 && world.groups()[world.surfaces()[s.surface.value].group.value] == "screen") at = s;
    return at;
  };
  BeamSpot const behind = arrives("use: viewport");
  EXPECT_NEAR(behind.power, 1, 2e-4);
  EXPECT_NEAR(behind.path_length, 2 + 0.44963 * 6e-3, 1e-7);
  EXPECT_NEAR(arrives("use: viewport, medium: none").path_length, 2, 1e-12);
  EXPECT_EQ(arrives("use: plate, material: white").power, 0);
}

// A lens of fused silica, f = R/(2 (n - 1)) = 0.111 m for R = 0.1 m on both faces: 1 mm (1 m/f - 1) wide on the screen.
// Control: without glass.
TEST(Glass, LensFocusesWithoutAMedium) {
  auto const width = [](std::string const& medium) {
    World const world = read(entry("use: lens, radius_1: 0.1 m, radius_2: 0.1 m, material: clear" + medium)).world;
    double found = 0;
    for (BeamSpot const& s : testing::beam_spots(world, launches(world).front(), {}))
      if (s.order == 0 && world.groups()[world.surfaces()[s.surface.value].group.value] == "screen")
        found = spot(s.mode).major;
    return found;
  };
  EXPECT_NEAR(width("") / 8e-3, 1, 0.1);
  EXPECT_LT(width(", medium: none"), 2e-3);
}

TEST(Glass, FacesThatAllReflectTrapTheLight) {
  std::string const both = entry("use: thick_mirror, material: hr"),
                    sound = entry("use: thick_mirror, material: hr, surfaces: {back: clear, barrel: black}");
  testing::BuiltScene const trap = read(both, "", ", lit: yes");
  EXPECT_THAT(trap.warnings, HasSubstr("light that enters glass is trapped in it"));
  EXPECT_THAT(trap.warnings, HasSubstr("'x/front' 0.999995, "));
  std::string const other =
      "  - {name: other, shape: {disk: {outer_radius: 1 cm}}, at: [1 m, 0 m, 0 m], body: b, material: white}\n";
  std::string const second = read(other + both).warnings;
  EXPECT_THAT(second, HasSubstr("- {name: x, ")) << "at the entry that is meant, not at the first";
  EXPECT_THAT(second, Not(HasSubstr("- {name: other, ")));
  EXPECT_LE(trap.world.footprints().size(), 4u) << "the light of the trap is not a main beam";
  EXPECT_THAT(read(sound, "", ", lit: yes").warnings, Not(HasSubstr("trapped")));
}

std::string slab(std::string const& words) {
  return "parts:\n  slab:\n    faces:\n      front: {shape: {disk: {outer_radius: 2 cm}}}\n"
         "      barrel: {shape: {cylinder: {radius: 2 cm, from: -5 mm, to: 0 m}}, material: black}\n"
         "      back: {shape: {disk: {outer_radius: 2 cm}}, at: [0 m, 0 m, -5 mm], facing: [0, 0, -1]" +
         words + "}\n";
}
TEST(Glass, SolidsWithoutGlassAreAWarning) {
  std::string const said = "'x' lets light through its faces, but nothing is between them";
  EXPECT_THAT(read(entry("use: slab, material: clear"), slab("")).warnings, HasSubstr(said));
  EXPECT_THAT(read(entry("use: slab, material: clear, repeat: {count: 3, along: x, pitch: 1 m}"), slab("")).warnings,
              HasSubstr("warning: " + said + ": it"))
      << "once for all";
  EXPECT_THAT(read(entry("shape: {sphere: {radius: 1 cm}}, material: clear")).warnings, HasSubstr(said));
  EXPECT_EQ(read(entry("use: slab, material: clear, medium: none"), slab("")).warnings, "");
  EXPECT_EQ(read(entry("use: slab, material: clear, medium: bk7"), slab("")).warnings, "");
  EXPECT_EQ(read(entry("use: slab, material: clear"), slab(", material: black")).warnings, "") << "light enters only";
  EXPECT_EQ(read(entry("shape: {disk: {outer_radius: 1 cm}}, material: clear")).warnings, "") << "a sheet";
  std::string const usual = "    medium: bk7\n";
  testing::BuiltScene const own = read(entry("use: slab, material: clear"), slab("") + usual);
  EXPECT_EQ(own.warnings, "");
  EXPECT_NEAR(index_of(own.world), 1.50663, 1e-5);
}

TEST(Glass, GlassThatNoLightEntersIsAWarning) {
  std::string const said = "'x' is filled with 'bk7', but none of its faces lets light in";
  EXPECT_THAT(read(entry("use: lens, material: white, medium: bk7")).warnings, HasSubstr(said));
  EXPECT_EQ(read(entry("use: lens, material: white, medium: none")).warnings, "");
  EXPECT_EQ(read(entry("use: lens, material: clear, medium: bk7")).warnings, "");
}

// A lens or mirror substrate of opaque faces takes the whole beam without a word about the missing medium. Controls: a
// medium deliberately set to none, faces that transmit or reflect, a lens beside the beam.
TEST(Glass, AnOpaqueOpticThatEndsTheBeamIsAWarning) {
  std::string const said = "'x' is opaque: beam '";
  for (std::string const part : {"lens", "thick_mirror", "plate"}) {
    EXPECT_THAT(read(entry("use: " + part + ", material: white")).warnings, HasSubstr(said)) << part;
    EXPECT_EQ(read(entry("use: " + part + ", material: white, medium: none")).warnings, "") << part;
    EXPECT_THAT(read(entry("use: " + part + ", material: clear")).warnings, Not(HasSubstr(said))) << part;
  }
  EXPECT_THAT(read(entry("use: thick_mirror, material: hr")).warnings, Not(HasSubstr(said)));
  EXPECT_THAT(read(entry("use: lens, material: white, at: [1 m, 0 m, 0 m]")).warnings, Not(HasSubstr(said)));
}

// Light that misses one object many times is reported once, with the worst case.
TEST(Glass, LightThatMissesAnObjectIsReportedOnce) {
  std::string const cavity =
      "  - {name: near, shape: {disk: {outer_radius: 1.5 mm}}, facing: [0, 0, 1], side: front, at: [0 m, 0 m, -1.1 m], "
      "body: b, material: hr}\n"
      "  - {name: far, shape: {disk: {outer_radius: 1.5 mm}}, facing: [0, 0, -1], side: front, at: [0 m, 0 m, 0.9 m], "
      "body: b, material: hr}\n";
  std::string const said = read(cavity, "", ", lit: {floor: 0.5}").warnings;
  std::size_t count = 0;
  for (auto at = said.find("falls beside"); at != said.npos; at = said.find("falls beside", at + 1)) ++count;
  EXPECT_EQ(count, 2u) << said;
  EXPECT_THAT(said, HasSubstr("spots"));
}

// A thick mirror has no one face for a cavity to choose: the message offers those it has. Controls: the face that is
// named makes the cavity; a thin mirror is taken by its name.
TEST(Glass, ACavityIsOfferedTheFacesOfAThickMirror) {
  auto const arm = [](std::string const& end, std::string const& part) {
    return std::string(head) + "scene:\n" +
           "  - {name: ITM, use: mirror, radius: 17 cm, radius_of_curvature: 1420 m, facing: [0, 0, 1], body: b, "
           "material: hr}\n" +
           "  - {name: ETM, use: " + part +
           ", radius: 17 cm, radius_of_curvature: 1683 m, at: [0 m, 0 m, 3000 m], facing: [0, 0, -1], body: b, "
           "material: hr}\n"
           "beams: {arm: {cavity: [ITM, " +
           end + "]}}\nports: {ITM: {beam: arm, at: ITM}}\n";
  };
  auto const rejected = [&](std::string const& end, std::string const& part) {
    return test::message_of([&] { with_library(arm(end, part)); });
  };
  std::string const offered = rejected("ETM", "thick_mirror");
  EXPECT_THAT(offered, HasSubstr("'ETM' has several faces"));
  EXPECT_THAT(offered, HasSubstr("name one: ETM/back, ETM/barrel, ETM/front"));
  EXPECT_EQ(rejected("ETM/front", "thick_mirror"), "no error");
  EXPECT_EQ(rejected("ETM", "mirror"), "no error");
  EXPECT_THAT(rejected("ETM/barrel", "thick_mirror"), HasSubstr("a mirror of a cavity cannot be of shape"));
  EXPECT_EQ(with_library(arm("ETM/front", "thick_mirror")).world.footprints().size(), 2u);
}

}  // namespace
}  // namespace straytrace::world_glass
