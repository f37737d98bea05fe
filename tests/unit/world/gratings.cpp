// SPDX-License-Identifier: BSD-3-Clause
// Gratings in a scene: where they cannot be, and what is warned of (docs/reference/interfaces/grating.md).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/world/built_scene.hpp"

namespace straytrace::world_gratings {
namespace {

using ::testing::HasSubstr;

std::string said(std::string const& shape, std::string const& order = "1",
                 std::string const& beam = "{on: wall, radius: 1 cm}") {
  return testing::said_of(R"(straytrace: 1
materials:
  lines: {specular: {grating: {density: 600 /mm, grooves: [0, 1, 0], orders: [{order: )" +
                          order +
                          R"(, reflect: 50 %}]}}}
  steel: {scatter: {model: lambertian, tis: 1 %}}
bodies: {b: {motion: still}}
beams: {spot: )" + beam + R"(}
ports: {wall: {beam: spot, at: wall}}
scene:
  - {name: wall, shape: {cap: {outer_radius: 10 cm, curvature: 1 /m}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: b, material: steel}
  - {name: grating, shape: )" +
                          shape + R"(, facing: [0, 0, 1], body: b, material: lines}
)");
}

TEST(SceneGratings, WhereTheyCanBe) {
  EXPECT_EQ(said("{disk: {outer_radius: 10 cm}}"), "");
  EXPECT_EQ(said("{cap: {outer_radius: 10 cm, curvature: 1 /m}}"), "");
  EXPECT_THAT(said("{cylinder: {radius: 1 m, from: -2 m, to: 2 m}}"),
              HasSubstr("the lines of the grating 'grating' have no spacing along its surface"));
  EXPECT_THAT(said("{disk: {outer_radius: 10 cm}}", "4"),
              HasSubstr("a.yaml:3:79: warning: order 4 propagates in vacuum at no incidence"));
  EXPECT_THAT(said("{cap: {outer_radius: 10 cm, curvature: 1 /m}}", "1", "{cavity: [grating, wall]}"),
              HasSubstr("'grating' is a grating: the mode of a cavity with gratings is not computed"));
}

}  // namespace
}  // namespace straytrace::world_gratings
