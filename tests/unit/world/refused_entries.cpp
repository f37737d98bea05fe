// SPDX-License-Identifier: BSD-3-Clause
// An entry of the scene with an error of its own: names of this entry elsewhere cause no further errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/world/built_scene.hpp"

namespace straytrace::world_refused {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string mirror(std::string const& name, std::string const& z, std::string const& facing, std::string const& shape) {
  return "  - {name: " + name + ", " + shape + ", at: [0 m, 0 m, " + z + "], facing: " + facing +
         ", body: b, material: m}\n";
}

std::string const cap = "shape: {cap: {curvature: 5e-4 /m, outer_radius: 10 cm}}";

// A cavity of ITM and ETM, which everything that can name a surface names as well.
std::string said(std::string const& facing, std::string const& shape, std::string const& cavity = "[ITM, ETM]") {
  return testing::said_of(
      "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 10 ppm}}}\nbodies: {b: {motion: still}}\n"
      "scene:\n" +
      mirror("ITM", "0 m", "[0, 0, 1]", cap) + mirror("ETM", "3 km", facing, shape) +
      mirror("rim", "1 km", "[0, 0, 1]", "shape: {disk: {inner_radius: 30 cm, outer_radius: 40 cm}}") +
      "beams:\n  arm: {cavity: " + cavity +
      "}\n  spot: {on: ETM, radius: 1 cm}\n"
      "  seen: {from: [1 m, 0 m, 1 m], facing: [0, 0, 1], radius: 1 mm, lit: {only: [\"ETM*\"]}}\n"
      "ports: {in: {beam: arm, at: ITM}, out: {beam: arm, at: ETM}}\nreceivers: {PD: {on: ETM}}\n"
      "edges: {surfaces: [rim, ETM]}\nwave: {beam: arm, baffles: \"ETM*\", maps: {ETM: {seed: 2}}}\n");
}

TEST(RefusedEntries, OnlyTheirOwnErrorIsPrinted) {
  struct Damage {
    std::string facing, shape, error;
  };
  for (Damage const& d : std::vector<Damage>{
           {"[0, 0, 0]", cap, "a direction of length zero"},
           {"[0, 0, nothing]", cap, "parameter 'nothing' is not defined"},
           {"[0, 0, -1]", "shape: {capp: {curvature: 5e-4 /m, outer_radius: 10 cm}}", "unknown shape 'capp'"},
           {"[0, 0, -1]", "shape: {cap: {curvature: 5e-4 /m, outer_radius: 3000 km}}", "'outer_radius' must be"},
           {"[0, 0, -1]", "shape: {cap: {curvature: 5e-4 /m}}", "key 'outer_radius' (a length) is missing"},
           {"[0, 0, -1]", "shape: {cap: {curvature: 1 /m, outer_radius: 2 m}}", "error"},
           {"[0, 0, -1]", "file: missing.obj, units: mm, surfaces: {default: m}", "cannot read file 'missing.obj'"},
           {"[0, 0, -1]", "use: no_such_part", "part 'no_such_part' is not defined"}})
    EXPECT_THAT(said(d.facing, d.shape), AllOf(HasSubstr(d.error), HasSubstr("1 error."))) << d.shape << d.facing;
}

// Negative control: of sound entries each name that is wrong is an error of its own.
TEST(RefusedEntries, SoundEntriesHideNoError) {
  std::string const none = said("[0, 0, -1]", cap, "[ITM, EMT]");
  EXPECT_THAT(none, AllOf(HasSubstr("'EMT' is not a surface"), HasSubstr("did you mean 'ETM'?")));
  EXPECT_THAT(said("[0, 0, 1]", cap), HasSubstr("do not face each other"));
  EXPECT_THAT(said("[0, 0, 0]", cap, "[ITM, EMT]"),
              AllOf(HasSubstr("length zero"), HasSubstr("'EMT' is not a surface")));
}

// A name that is taken, missing or misspelt, and a misspelt 'shape', hide nothing else of their entries.
TEST(RefusedEntries, AWrongNameHidesNoError) {
  auto const said_of_entry = [](std::string const& keys) {
    return testing::said_of(
        "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 10 ppm}}}\nbodies: {b: {motion: still}}\n"
        "scene:\n" +
        mirror("M1", "0 m", "[0, 0, 1]", cap) + "  - {" + keys + ", at: [0 m, 0 m, 1 m], body: b, material: mm}\n" +
        "beams: {spot: {on: M1, radius: 1 cm}}\nreceivers: {PD: {on: M1}}\n");
  };
  std::string const radus = "shape: {disk: {outer_radus: 5 cm}}", material = "material 'mm' is not defined";
  auto const shape = AllOf(HasSubstr("unknown key 'outer_radus'"), HasSubstr("did you mean 'outer_radius'?"));
  EXPECT_THAT(said_of_entry("name: M1, " + radus),
              AllOf(HasSubstr("name 'M1' is used twice"), shape, HasSubstr(material), HasSubstr("3 errors.")));
  EXPECT_THAT(said_of_entry(radus),
              AllOf(HasSubstr("key 'name' (text) is missing"), shape, HasSubstr(material), HasSubstr("3 errors.")));
  EXPECT_THAT(said_of_entry("nmae: M2, " + radus), AllOf(HasSubstr("unknown key 'nmae'"), HasSubstr("'name'?"), shape,
                                                         HasSubstr(material), HasSubstr("3 errors.")));
  EXPECT_THAT(said_of_entry("name: M2, shpe: {disk: {outer_radius: 5 cm}}"),
              AllOf(HasSubstr("unknown key 'shpe'"), HasSubstr("did you mean 'shape'?"), HasSubstr(material),
                    HasSubstr("2 errors.")));
  EXPECT_THAT(said_of_entry("name: M2, outer_radius: 5 cm"),
              AllOf(HasSubstr("entry 'M2' has neither 'use' nor"), HasSubstr(material), HasSubstr("2 errors.")));
  EXPECT_THAT(said_of_entry("name: M2, shape: {disk: {outer_radius: 5 cm}}"),
              AllOf(HasSubstr(material), HasSubstr("1 error.")));  // control
}

// Without the model, the other keys of the law are unknown: only the misspelt one is named.
TEST(RefusedEntries, AMisspeltModelIsNamed) {
  auto const said_of_law = [](std::string const& law) {
    return testing::said_of("straytrace: 1\nmaterials: {m: {scatter: {" + law + "}}}\nbodies: {b: {motion: still}}\n" +
                            "scene:\n" + mirror("M1", "0 m", "[0, 0, 1]", cap) +
                            "beams: {spot: {on: M1, radius: 1 cm}}\nreceivers: {PD: {on: M1}}\n");
  };
  EXPECT_THAT(said_of_law("modle: lambertian, tis: 1 %"),
              AllOf(HasSubstr("unknown key 'modle' in a BSDF model"), HasSubstr("did you mean 'model'?"),
                    HasSubstr("1 error.")));
  EXPECT_THAT(said_of_law("tis: 1 %"), AllOf(HasSubstr("key 'model' (a choice) is missing"), HasSubstr("1 error.")));
}

}  // namespace
}  // namespace straytrace::world_refused
