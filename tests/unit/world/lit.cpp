// SPDX-License-Identifier: BSD-3-Clause
// The key `lit` and ports without a place -> world, and the messages about mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/message_of.hpp"
#include "unit/world/built_scene.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::world_lit {
namespace {

using ::testing::HasSubstr;

constexpr char bench[] =
    "straytrace: 1\nmaterials:\n  white: {scatter: {model: lambertian, tis: 10 %}}\n"
    "  window: {specular: {reflect: 4 %, transmit: 95 %}, scatter: {model: lambertian, tis: 1 %}}\n"
    "  clear: {specular: {reflect: 1 %, transmit: 99 %}}\n"
    "bodies: {b: {motion: still}}\nscene:\n"
    "  - {name: window, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: b, "
    "material: "
    "window}\n"
    "  - {name: clear, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 2 m], facing: [0, 0, -1], body: b, "
    "material: "
    "clear}\n"
    "  - {name: dump, shape: {disk: {outer_radius: 2 mm}}, at: [0 m, 0 m, 3 m], facing: [0, 0, -1], body: b, material: "
    "white}\n";

testing::BuiltScene read(std::string const& beam, std::string const& rest) {
  return testing::built(bench + ("beams: {probe: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], " + beam) + "}}\n" + rest);
}
std::string complaint(std::string const& beam, std::string const& rest) {
  return test::message_of([&] { read(beam, rest); });
}
// Names of the surfaces at which a port is open, in the order of the footprints.
std::string open_at(World const& world, std::string const& port) {
  std::string names;
  for (Footprint const& f : world.footprints())
    if (f.port.valid() && world.ports()[f.port.value] == port)
      names += world.groups()[world.surfaces()[f.surface.value].group.value] + " ";
  return names;
}

TEST(ReadLit, PortsWithoutAPlaceTakeTheRemainingSurfaces) {
  std::string const beam = "radius: 1 mm, lit: yes";
  testing::BuiltScene const r = read(beam, "ports: {rest: {beam: probe}, one: {beam: probe, at: dump}}\n");
  EXPECT_EQ(open_at(r.world, "one"), "dump ");
  EXPECT_EQ(open_at(r.world, "rest"), "window ");  // 'clear' scatters nothing
  EXPECT_EQ(open_at(read(beam, "ports: {some: {beam: probe, at: \"win*\"}}\n").world, "some"), "window ");
  testing::BuiltScene const all = read(beam, "ports: {all: {beam: probe}}\n");
  EXPECT_EQ(open_at(all.world, "all"), "window dump ");
  for (Footprint const& f : all.world.footprints())
    EXPECT_EQ(f.emits, f.receives);  // a free beam that is followed is not traced as rays
}

TEST(ReadLit, ListOfWhatIsLit) {
  testing::BuiltScene const r = read("radius: 1 mm, lit: yes", "ports: {all: {beam: probe}}\n");
  std::vector<LitRow> const rows = lit_rows(r.world);
  ASSERT_EQ(rows.size(), 3u);
  double const w = 1e-3 * std::hypot(1, 3 * 1.064e-6 / (pi * 1e-6));
  EXPECT_NEAR(rows[2].major, w, 1e-9);
  EXPECT_NEAR(rows[2].clipped, std::exp(-2 * 4e-6 / (w * w)), 1e-6);  // eq. 5.5
  EXPECT_FALSE(rows[1].scatters);
  EXPECT_NEAR(rows[0].incidence, 0, 1e-12);
  EXPECT_NEAR(r.world.feeds().back().path_length, 3, 1e-12);
  EXPECT_NEAR(r.world.footprints().back().share, 0.95 * 0.99, 1e-9);
  EXPECT_THAT(r.warnings, HasSubstr("of the light of 'probe' falls beside 'dump'"));
}

TEST(ReadLit, MistakesAreNamed) {
  std::string const port = "ports: {all: {beam: probe}}\n";
  EXPECT_THAT(complaint("radius: 1 mm, lit: {only: [dumb]}", port), HasSubstr("did you mean 'dump'?"));
  EXPECT_THAT(complaint("radius: 1 mm, lit: {flour: 1e-9}", port), HasSubstr("did you mean 'floor'?"));
  EXPECT_THAT(complaint("radius: 1 mm, profile: even, lit: yes", port), HasSubstr("only a Gaussian beam"));
  EXPECT_THAT(complaint("radius: 1 mm, lit: {only: [clear]}", port), HasSubstr("illuminates no surface that scatters"));
  EXPECT_THAT(complaint("radius: 1 mm, lit: yes", "ports: {a: {beam: probe, at: dump}, b: {beam: probe, at: dump}}\n"),
              HasSubstr("port 'a' is already there"));
  EXPECT_THAT(complaint("radius: 1 mm, lit: {only: [window]}", "ports: {a: {beam: probe, at: dump}}\n"),
              HasSubstr("beam 'probe' does not illuminate 'dump'"));
}

TEST(ReadLit, TheSameLightTwiceIsAWarning) {
  FileTexts const texts{
      {"a.yaml", std::string(bench) +
                     "beams:\n  probe: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 1 mm, lit: {only: "
                     "[window]}}\n"
                     "  stated: {on: window, travel: [0, 0, 1], radius: 1 mm}\n"
                     "ports: {a: {beam: probe}}\n"}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  build_world(scene);
  EXPECT_THAT(scene.warnings(), HasSubstr("'window' is lit by beam 'stated' too"));
}

// Light that a splitter divides and recombines: fields add there, which powers ignore.
TEST(ReadLit, RecombiningBeamsAreAWarning) {
  auto const warnings = [](std::string const& arms) {
    FileTexts const texts{
        {"a.yaml",
         "straytrace: 1\nmaterials:\n  half: {specular: {reflect: 50 %, transmit: 50 %}}\n"
         "  mirror: {specular: {reflect: 99 %}}\n  white: {scatter: {model: lambertian, tis: 10 %}}\n"
         "bodies: {b: {motion: still}}\nscene:\n"
         "  - {name: splitter, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [1, 0, -1], body: b, "
         "material: half}\n" +
             arms +
             "  - {name: output, shape: {disk: {outer_radius: 5 cm}}, at: [-1 m, 0 m, 1 m], facing: [1, 0, 0], body: "
             "b, "
             "material: white}\n"
             "beams: {probe: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 1 mm, lit: yes}}\n"
             "ports: {a: {beam: probe, at: output}}\n"}};
    Scene const scene = read_scene("a.yaml", {}, &texts);
    World const world = build_world(scene);
    return scene.warnings();
  };
  std::string const one =
      "  - {name: z, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 2 m], facing: [0, 0, -1], body: b, "
      "material: mirror}\n";
  std::string const other =
      "  - {name: x, shape: {disk: {outer_radius: 5 cm}}, at: [1 m, 0 m, 1 m], facing: [-1, 0, 0], body: b, "
      "material: mirror}\n";
  EXPECT_THAT(warnings(one + other), HasSubstr("'output' is lit by 'probe' on two ways that run together"));
  EXPECT_THAT(warnings(one), ::testing::Not(HasSubstr("on two ways")));  // control: one arm
}

}  // namespace
}  // namespace straytrace::world_lit
