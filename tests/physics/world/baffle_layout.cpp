// SPDX-License-Identifier: BSD-3-Clause
// The shadow rule of baffles (docs/theory/arm.md, eq. 8.16, case A24) as a user lays baffles out: no straight line
// leads from the mirror to the wall.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "scene/scene.hpp"
#include "support/recorded.hpp"
#include "world/model/world.hpp"

namespace straytrace::world_baffle_layout {
namespace {

constexpr double tube = 0.4, height = 0.04, mirror = 0.11, first = 10;  // m, KAGRA
constexpr int baffles = 40;

double ratio_of_8_16() { return (tube + mirror) / (tube - height + mirror); }

World tube_with(std::string const& ratio) {
  FileTexts const texts{
      {"a.yaml",
       "straytrace: 1\nmaterials: {black: {scatter: {model: lambertian, tis: 1 %}}}\nbodies: {b: {motion: still}}\n"
       "params: {tube: 40 cm, height: 4 cm, mirror: 11 cm}\nscene:\n"
       "  - {name: mirror, shape: {disk: {outer_radius: mirror}}, body: b, material: black}\n"
       "  - {name: wall, shape: {cylinder: {radius: tube, from: -1 m, to: 1 km}}, side: inner, body: b, material: "
       "black}\n"
       "  - {name: baffle, shape: {disk: {inner_radius: tube - height, outer_radius: tube}}, body: b, material: "
       "black,\n"
       "     repeat: {count: 40, along: z, from: 10 m, ratio: " +
           ratio + "}}\nbeams: {s: {on: mirror, radius: 1 cm}}\nports: {p: {beam: s, at: mirror}}\n"}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

bool sees_wall(World const& world, Vec3 from, Vec3 to) {
  Hit const hit = world.view().closest({from, unit(to - from)}, SurfaceId{0});
  return world.groups()[world.surfaces()[hit.surface.value].group.value] == "wall";
}

// Of the lines from the far edge of the mirror that pass just inside the inner edge of a baffle, those that reach the
// wall.
int open_gaps(World const& world, double ratio) {
  int open = 0;
  double z = first;
  for (int i = 0; i + 1 < baffles; ++i, z *= ratio)
    open += sees_wall(world, {-mirror, 0, 0}, {tube - height - 1e-9, 0, z});
  return open;
}

// Points of the mirror and of the wall between the first and the last baffle.
int lines_to_the_wall(World const& world, double ratio, int lines) {
  int open = 0;
  for (int i = 0; i < lines; ++i) {
    Rng rng(24, static_cast<std::uint64_t>(i), 0, Stream::source);
    double const at = first * std::pow(ratio, rng.uniform() * (baffles - 1)), r = mirror * std::sqrt(rng.uniform());
    SinCos const on_mirror = sincos_turn(rng.uniform()), on_wall = sincos_turn(rng.uniform());
    open += sees_wall(world, {r * on_mirror.cos, r * on_mirror.sin, 0}, {tube * on_wall.cos, tube * on_wall.sin, at});
  }
  return open;
}

// The rule is exact: with a ratio 1e-6 larger every gap is open to the grazing line, with 3 % more random lines find
// it.
TEST(baffle_layout, no_line_from_mirror_to_wall_a24) {
  double const ratio = ratio_of_8_16();
  EXPECT_NEAR(ratio, 1.08511, 5e-6);
  World const closed = tube_with("(tube + mirror)/(tube - height + mirror)*(1 - 1e-6)"),
              open = tube_with("(tube + mirror)/(tube - height + mirror)*(1 + 1e-6)"),
              wide = tube_with("(tube + mirror)/(tube - height + mirror)*1.03");
  EXPECT_EQ(open_gaps(closed, ratio * (1 - 1e-6)), 0);
  EXPECT_EQ(open_gaps(open, ratio * (1 + 1e-6)), baffles - 1);
  EXPECT_EQ(lines_to_the_wall(closed, ratio, 100000), 0);
  EXPECT_GT(lines_to_the_wall(wide, 1.03 * ratio, 100000), 100);
}

}  // namespace
}  // namespace straytrace::world_baffle_layout
