// SPDX-License-Identifier: BSD-3-Clause
// The key `imperfections` (docs/reference/imperfections.md): errors with their places and reasons.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/world/built_scene.hpp"

namespace straytrace::world_imperfections {
namespace {

using ::testing::HasSubstr;

std::string said(std::string const& imperfections) {
  return testing::said_of(R"(straytrace: 1
materials: {clean: {specular: {reflect: 1}}, pit: {scatter: {model: lambertian, tis: 1}}}
bodies: {b: {motion: still}}
beams: {spot: {on: mirror, radius: 1 cm}}
ports: {mirror: {beam: spot, at: mirror}}
scene:
  - name: mirror
    shape: {disk: {outer_radius: 10 cm}}
    facing: [0, 0, 1]
    body: b
    material: clean
    imperfections: )" + imperfections +
                          "\n");
}

TEST(Imperfections, ErrorsNamePlaceAndRemedy) {
  EXPECT_EQ(said("[{at: [1 cm, 0 cm], diameter: 50 um, material: pit}]"), "");
  struct Case {
    std::string row, words;
  };
  for (Case const& c : std::vector<Case>{
           {"[{at: [1 cm, 0 cm], diameter: 50 um}]", "a.yaml:12:21: error: the imperfection has no material"},
           {"[{at: [1 cm, 0 cm], diameter: 50 um, material: dirt}]", "material 'dirt' is not defined"},
           {"[{at: [1 cm, 0 cm], material: pit}]", "the size of the imperfection is missing"},
           {"[{at: [1 cm, 0 cm], diameter: 50 um, dig: 5, material: pit}]", "two sizes of one imperfection"},
           {"[{at: [1 cm, 0 cm], diameter: 50 um, count: 2, material: pit}]", "'count' draws places"},
           {"[{at: [11 cm, 0 cm], diameter: 50 um, material: pit}]", "'mirror/dig_1' lies beside the surface"},
           {"[{count: 2, diameter: [50 um, 10 um], material: pit}]",
            "from the smallest, at least 1 nm, to the largest"},
           {"[{scratch: [[0 mm, 0 mm]], width: 2 um, material: pit}]", "a scratch runs between two places"},
           {"[{count: 400, dig: 1, material: pit}, {count: 400, dig: 1, material: pit}]",
            "more than 500 imperfections"},
           {"[{at: [1 cm, 0 cm], dig: 5, material: pit, grad: 3}]", "grad"},
           {"[{at: [1 cm, 0 cm], dig: 5, material: pit, face: front}]", "no face 'front'"},
           {"[{count: 60, dig: 1, material: pit}]", "warning: more than 50 single imperfections"},
           {"[{at: [1 cm, 0 cm], dig: 5, facet: 4 %, material: pit}]", "'facet' and 'material' are both given"},
           {"[{at: [1 cm, 0 cm], dig: 5, facet: 4 %, tilt: [85 deg, 0 deg]}]", "more than 80 deg"},
           {"[{chamfer: 5 cm, material: pit}]", "the chamfer is wide against the surface"},
           {"[{chamfer: 1 mm, material: pit, tilt: [1 deg, 0 deg]}]", "'tilt' is of a single disc"},
           {"[{at: [1 cm, 0 cm], diameter: 1 cm, material: pit}]", "is 0.5 of the beam 'spot' wide"},
           {"[{count: 2, diameter: [1e-300 m, 10 um], material: pit}]", "at least 1 nm"},
           {"[{scratch: [[0 mm, 0 mm], [0 mm, 0 mm]], width: 2 um, material: pit}]", "no longer than it is wide"},
           {"[{chamfer: 1 mm}]", "the imperfection has no material"},
           {"[dig]", "an imperfection is a table"}})
    EXPECT_THAT(said(c.row), HasSubstr(c.words)) << c.row;
}

}  // namespace
}  // namespace straytrace::world_imperfections
