// SPDX-License-Identifier: BSD-3-Clause
// Errors inside a built-in part are reported at the entry that uses it.
#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string check(std::string const& entry, std::string const& parts = "") {
  Folder const folder;
  write_text(
      folder / "a.yaml",
      "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 10 %}}}\nbodies: {b: {motion: still}}\n" +
          parts + "scene:\n  - {name: x, body: b, material: m, " + entry +
          "}\n  - {name: lit, shape: {disk: {outer_radius: 1 mm}}, at: [0 m, 0 m, 900 m], body: b, material: m}\n"
          "beams: {s: {on: lit, radius: 1 mm}}\nreceivers: {lit: {on: lit}}\n");
  return straytrace({"check", folder / "a.yaml"}).err;
}

// R3.06: two faces of RoC 0.1 m and 90 mm across have sags of 10.697 mm each.
TEST(PartErrors, SizesThatDoNotFitAreExplained) {
  struct Case {
    char const *entry, *what, *reason;
  };
  for (Case const& c : {
           Case{"use: lens, radius_1: 0.1 m, diameter: 9 cm, thickness: 1 mm",
                "a.yaml:5:92: error: 'thickness' of 'x' must be more than 10.7 mm here, it is 1 mm", "would meet"},
           {"use: lens, radius_1: 0.1 m, diameter: 9 cm",
            "a.yaml:5:5: error: 'thickness' of 'x' must be more than 10.7", "would meet"},
           {"use: lens, radius_1: 1 cm", "'diameter' of 'x' must be at most 20 mm here, it is 25.4 mm", "sphere"},
           {"use: lens, thickness: 0 m", "'thickness' of 'x' must be more than 0 mm", "would meet"},
           {"use: thick_mirror, wedge: 50 deg", "'wedge' of 'x' must be at most 48.81 deg here, it is 50 deg",
            "tilted"},
           {"use: plate, wedge: -30 deg", "'wedge' of 'x' must be at least -21.48 deg", "tilted"},
           {"use: conical_baffle, inner_radius: 60 cm", "'outer_radius' of 'x' must be more than 600 mm", "the hole"},
           {"use: photodiode, window_thickness: 0 m", "'window_thickness' of 'x' must be more than 0 mm", "change"},
       }) {
    std::string const said = check(c.entry);
    EXPECT_THAT(said, HasSubstr(c.what)) << c.entry;
    EXPECT_THAT(said, HasSubstr(c.reason)) << c.entry;
    EXPECT_THAT(said, HasSubstr("1 error.")) << c.entry;
    EXPECT_THAT(said, Not(HasSubstr("built-in parts:"))) << c.entry;
  }
  EXPECT_EQ(check("use: lens, radius_1: 0.1 m, diameter: 9 cm, thickness: 11 mm"), "");  // controls: just inside
  EXPECT_EQ(check("use: lens, radius_1: 1 cm, diameter: 2 cm, thickness: 11 mm"), "");
  EXPECT_EQ(check("use: plate, wedge: -21.47 deg"), "");
}

TEST(PartErrors, UnforeseenErrorsNameTheEntryAndTheFace) {
  std::string const said = check("use: serrated_baffle, inner_radius: 60 cm");
  EXPECT_THAT(said, HasSubstr("a.yaml:5:5: error: 'x'"));
  EXPECT_THAT(said, HasSubstr("change the parameters of the part (built-in parts:"));
  EXPECT_THAT(check("use: tube_section, radius: 2000 m"),
              HasSubstr("error: 'radius' does not suit the part 'tube_section'"));
}

// A size that no face of the part can have is one error, at the value. Control: a size of another part.
TEST(PartErrors, AnImpossibleSizeIsReportedOnceWhereItIsGiven) {
  std::string const said = check("use: lens, diameter: -25 mm");
  EXPECT_THAT(said, HasSubstr("a.yaml:5:58: error: 'diameter' does not suit the part 'lens'"));
  EXPECT_THAT(said, HasSubstr("change it: 'outer_radius' must be"));
  EXPECT_THAT(said, HasSubstr("1 error."));
  EXPECT_THAT(said, Not(HasSubstr("built-in parts")));
  EXPECT_THAT(check("use: chamber, width: -1 m, height: -1 m"), HasSubstr("2 errors."));
}

// A part of one's own keeps the place where it is written.
TEST(PartErrors, ErrorsOfOwnPartsStateTheirPlace) {
  std::string const said =
      check("use: p", "parts: {p: {faces: {a: {shape: {cylinder: {radius: 1 m, from: 1 m, to: 0 m}}}}}}\n");
  EXPECT_THAT(said, HasSubstr("a.yaml:4:43: error: the cylinder ends"));
}

TEST(PartErrors, LimitsAndMessagesOfParts) {
  std::string const part =
      "parts: {p: {params: {r: 1 m, way: 1}, limits: {r: {at_most: 2 m, because: it must go through the door}}, "
      "words: {way: {up: 1, down: -1}}, faces: {a: {shape: {disk: {outer_radius: r}}, at: [0 m, way*1 m, 0 m]}}}}\n";
  EXPECT_EQ(check("use: p, r: 2 m, way: down", part), "");
  EXPECT_THAT(check("use: p, r: 2.1 m", part), HasSubstr("^^^ it must go through the door"));
  EXPECT_THAT(check("use: p, way: left", part), HasSubstr("'way' is up or down, got \"left\""));
  EXPECT_THAT(check("use: p", edited(part, "limits: {r:", "limits: {s:")), HasSubstr("'s' is not a parameter"));
  EXPECT_THAT(check("use: p", edited(part, "at_most", "at_moat")), HasSubstr("did you mean 'at_most'?"));
}

TEST(PartErrors, AnUnknownKeyIsReportedOnce) {
  std::string const said = check("use: lens, thicknes: 3 mm");
  EXPECT_THAT(said, HasSubstr("unknown key 'thicknes' in scene entry 'x'"));
  EXPECT_THAT(said, HasSubstr("1 error."));
  EXPECT_THAT(check("use: lens, thicknes: 3 mm, diametre: 1 cm"), HasSubstr("2 errors."));  // negative control
}

// Other wrong names of an entry are reported together with the error of its part.
// The material of an entry whose part has one for each face. Control: a face without one takes it.
TEST(PartErrors, AnIdleMaterialIsTold) {
  std::string const ring = "shape: {disk: {outer_radius: 1 cm}}";
  auto const said = [&](std::string const& face, std::string const& material) {
    Folder const folder;
    write_text(
        folder / "a.yaml",
        "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 10 %}}, n: {like: m}}\n"
        "bodies: {b: {motion: still}}\nparts: {own: {faces: {front: {" +
            ring + face + "}}}}\nscene:\n  - {name: x, use: own, body: b, material: " + material +
            "}\n  - {name: lit, shape: {disk: {outer_radius: 1 mm}}, at: [0 m, 0 m, 900 m], body: b, material: m}\n"
            "beams: {s: {on: lit, radius: 1 mm}}\nreceivers: {lit: {on: lit}}\n");
    return straytrace({"check", folder / "a.yaml"}).err;
  };
  EXPECT_THAT(said(", material: n", "m"), HasSubstr("this material of 'x' has no effect"));
  EXPECT_THAT(said(", material: n", "nosuch"), HasSubstr("material 'nosuch' is not defined"));
  EXPECT_THAT(said("", "m"), Not(HasSubstr("no effect")));
}

TEST(PartErrors, AnInvalidPartDoesNotHideTheNamesItUses) {
  std::string const rest = ", surfaces: {barrel: nono, back: nix}, medium: glas";
  for (std::string const use : {"use: lens, radius_1: 1 cm", "use: lenss"}) {
    std::string const said = check(use + rest);
    for (char const* words : {"material 'nix' is not defined", "material 'nono' is not defined", "'glas'", "4 errors."})
      EXPECT_THAT(said, HasSubstr(words)) << use;
  }
  EXPECT_THAT(check("use: lenss"), HasSubstr("1 error."));  // negative control
  std::string const inner =
      "parts: {p: {params: {r: 1 m}, limits: {r: {at_most: 1 m, because: it must fit}}, "
      "faces: {a: {shape: {disk: {outer_radius: r}}, material: nix}}}}\n";
  EXPECT_THAT(check("use: p, r: 2 m", inner), HasSubstr("material 'nix' is not defined"));
  EXPECT_THAT(check("use: p, r: 2 m", inner), HasSubstr("2 errors."));
}

// A beam on nothing is read to its end, and numbers that are missing do not misplace its mirrors.
TEST(PartErrors, AllErrorsOfABeamAreReported) {
  Folder const folder;
  auto const beam = [&](std::string const& params, std::string const& beams) {
    write_text(folder / "b.yaml",
               "straytrace: 1\n" + params +
                   "materials: {m: {scatter: {model: lambertian, tis: 10 %}}}\nbodies: {b: {motion: still}}\nscene:\n"
                   "  - {name: A, shape: {cap: {outer_radius: 10 cm, curvature: 1/R}}, body: b, material: m}\n"
                   "  - {name: B, shape: {cap: {outer_radius: 10 cm, curvature: 1/R}}, at: [0 m, 0 m, L], "
                   "facing: [0, 0, -1], body: b, material: m}\nreceivers: {B: {on: B}}\nbeams: " +
                   beams + "\n");
    return straytrace({"check", folder / "b.yaml"}).err;
  };
  std::string const good = "params: {L: 3 m, R: 10 m}\n";
  std::string const said = beam(good, "{s: {on: C, radius: 1 mm, centre: [0 m, 0 m, 5], colour: 3}}");
  for (char const* words :
       {"'C' is not a surface", "'centre' is a length, got \"5\"", "unknown key 'colour'", "3 errors."})
    EXPECT_THAT(said, HasSubstr(words));
  EXPECT_EQ(beam(good, "{s: {cavity: [A, B]}}"), "");
  for (std::string const params :
       {"params: {L: 3 mmm, R: 10 m}\n", "params: {L: 3 kg, R: 10 m}\n", "params: {L: 3, R: 10 m}\n"})
    EXPECT_THAT(beam(params, "{s: {cavity: [A, B]}}"), HasSubstr("1 error.")) << params;
  EXPECT_THAT(beam("params: {L: -3 m, R: 10 m}\n", "{s: {cavity: [A, B]}}"),
              HasSubstr("do not face"));  // negative control
}

TEST(PartErrors, TooManySidesAreReported) {
  std::string const said = check("shape: {polygon: {sides: 1e9, radius: 1 cm}}");
  EXPECT_THAT(said, HasSubstr("'sides' must be between 0 and 1000"));
  EXPECT_THAT(said, Not(HasSubstr("nan")));
  EXPECT_THAT(said, HasSubstr("1 error."));
}

}  // namespace
}  // namespace straytrace::testing
