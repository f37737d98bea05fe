// SPDX-License-Identifier: BSD-3-Clause
// Cavities of three mirrors or more in a scene (docs/reference/scene.md#beams-and-ports): rings, folded ones, and what
// is wrong with others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "unit/world/built_scene.hpp"

namespace straytrace::world_ring_cavities {
namespace {

using ::testing::AllOf;
using testing::built;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::said_of;

// An equilateral triangle of 4 m; C is curved.
std::string ring(std::string const& cavity, std::string const& more = "receivers: {R: {on: C}}\n",
                 std::string const& facing_b = "[-1.7320508075688772, 0, 1]") {
  std::string const as = ", body: still, material: m}\n";
  return "straytrace: 1\nmaterials: {m: {specular: {reflect: 99 %}, scatter: {model: lambertian, tis: 1e-4}}}\n"
         "bodies: {still: {motion: still}}\nscene:\n"
         "  - {name: A, shape: {disk: {outer_radius: 5 cm}}, at: [-2 m, 0 m, 0 m], facing: [1.7320508075688772, 0, 1]" +
         as + "  - {name: B, shape: {disk: {outer_radius: 5 cm}}, at: [2 m, 0 m, 0 m], facing: " + facing_b + as +
         "  - {name: C, shape: {cap: {curvature: 1/(20 m), outer_radius: 5 cm}}, at: [0 m, 0 m, 2 m * sqrt(3)], "
         "facing: [0, 0, -1]" +
         as + "beams: {b: {cavity: " + cavity + "}}\n" + more;
}

TEST(RingCavity, LightsItsMirrorsInTheirOrder) {
  World const world = built(ring("[A, B, C]")).world;
  ASSERT_EQ(world.footprints().size(), 3u);
  char const* const names[] = {"A", "B", "C"};
  for (std::uint32_t i = 0; i < 3; ++i) {
    Footprint const& f = world.footprints()[i];
    EXPECT_EQ(world.name_of(f.surface), names[i]);
    EXPECT_EQ(f.profile, Profile::astigmatic);
    EXPECT_FALSE(f.standing);
    EXPECT_TRUE(f.emits);
    EXPECT_NEAR(world.feeds()[i].path_length, 4.0 * i, 1e-9);
  }
  EXPECT_NEAR(world.footprints()[1].travel.x, 1, 1e-12);
  ASSERT_EQ(world.notes.size(), 1u);
  EXPECT_THAT(world.notes[0], AllOf(HasSubstr("ring cavity of 12 m per round trip"), HasSubstr("mm on A")));
}

// The other way around, the light meets the same fronts.
TEST(RingCavity, AMirrorThatIsTurnedShiftsTheAxis) {
  World const world = built(ring("[C, B, A]", "receivers: {R: {on: C}}\n", "[-1.7320508075688772, 0.0001, 1]")).world;
  ASSERT_EQ(world.notes.size(), 2u);
  EXPECT_THAT(world.notes[1], AllOf(HasSubstr("passes the vertices"), HasSubstr("mm on C")));
}

TEST(RingCavity, FoldedCavityMeetsTheFoldTwice) {
  std::string const folded =
      "straytrace: 1\nmaterials: {m: {specular: {reflect: 99 %}, scatter: {model: lambertian, tis: 1e-4}}}\n"
      "bodies: {still: {motion: still}}\nscene:\n"
      "  - {name: I, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 0 m], facing: [0, 0, 1], body: still, "
      "material: m}\n"
      "  - {name: F, shape: {disk: {outer_radius: 8 cm}}, at: [0 m, 0 m, 4 m], facing: [1, 0, -1], body: still, "
      "material: m}\n"
      "  - {name: E, shape: {cap: {curvature: 1/(20 m), outer_radius: 5 cm}}, at: [6 m, 0 m, 4 m], facing: [-1, 0, 0], "
      "body: still, material: m}\n"
      "beams: {b: {cavity: [I, F, E, F]}}\n";
  World const world = built(folded + "receivers: {R: {on: E}}\n").world;
  ASSERT_EQ(world.footprints().size(), 4u);
  EXPECT_EQ(world.footprints()[1].surface, world.footprints()[3].surface);
  EXPECT_THAT(world.notes[0], HasSubstr("folded cavity of 20 m per round trip"));
  EXPECT_THAT(said_of(folded + "ports: {P: {beam: b, at: I}}\n"), HasSubstr("rejoins a folded cavity is not computed"));
}

TEST(RingCavity, PortsOfARingWarn) {
  EXPECT_THAT(said_of(ring("[A, B, C]", "ports: {P: {beam: b}}\n")), HasSubstr("opposite direction alone"));
}

TEST(RingCavity, SaysWhatIsWrong) {
  EXPECT_THAT(said_of(ring("[A, B, C]", "receivers: {R: {on: C}}\n", "[-1, 0, 1]")),
              AllOf(HasSubstr("'B' at [2, 0, 0] m sends the light of 'A' past 'C'"),
                    HasSubstr("facing: [-0.866025404, 0, 0.5]")));
  EXPECT_THAT(said_of(ring("[A, B, B]")), HasSubstr("goes from 'B' to itself"));
  EXPECT_THAT(said_of(ring("[A]")), HasSubstr("two mirrors or more"));
  EXPECT_THAT(said_of(ring("[A, B, nowhere]")), HasSubstr("nowhere"));
  EXPECT_THAT(said_of(ring("[A, B, C]") + "wave: {beam: b, tolerance: {radius: 1 mm}}\n"),
              HasSubstr("'tolerance' works for two-mirror cavities only"));
  EXPECT_THAT(
      said_of(ring("[A, B, C]") + "wave: {beam: b, mirrors: {A: {tilt: [1 urad, 0 rad]}}, input: {radius: 3 mm},"
                                  " maps: {B: {defects: [{absorber: {radius: 1 mm, power: 1 mW}}]}}}\n"),
      AllOf(HasSubstr("'tilt' works for two-mirror cavities only"), HasSubstr("1 error.")));
  EXPECT_THAT(said_of(ring("[A, B, C]")), Not(HasSubstr("error")));
}

TEST(RingCavity, OfTheTableWave) {
  World const world = built(ring("[C, A, B]") + "wave: {beam: b, maps: {B: {spectrum: none}}}\n").world;
  EXPECT_TRUE(world.wave.ring);
  ASSERT_EQ(world.wave.mirrors.size(), 3u);
  EXPECT_EQ(world.name_of(world.wave.mirrors[0].surface), "C");
  EXPECT_EQ(world.wave.mirrors[2].heights, WaveSettings::Heights::none);
}

}  // namespace
}  // namespace straytrace::world_ring_cavities
