// SPDX-License-Identifier: BSD-3-Clause
// Parts, repeats and the names of instances (docs/reference/scene.md).
#include <cmath>

#include "unit/scene/support.hpp"

namespace straytrace::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string const baffle =
    "params: {aperture: 84 cm, L: 100 m, n: 3}\n"
    "parts:\n"
    "  baffle:\n"
    "    params: {aperture: 80 cm, half: aperture/2, far: L}\n"
    "    faces:\n"
    "      cone: {shape: {cone: {inner_radius: half}}, material: steel}\n"
    "      rim: {shape: {edge: {radius: aperture/2}}}\n"
    "  panel: {params: {r: 1 cm}, faces: {front: {shape: {disk: {outer_radius: r}}}}}\n"
    "scene:\n";

std::vector<std::string> names(Scene const& s) {
  std::vector<std::string> out;
  for (auto const& i : s.instances()) out.push_back(i.name);
  return out;
}
std::vector<std::string> groups(Scene const& s) {
  std::vector<std::string> out;
  for (auto const& i : s.instances()) out.push_back(i.group);
  return out;
}
std::vector<double> offsets(Scene const& s) {
  std::vector<double> out;
  for (auto const& i : s.instances()) out.push_back(i.offset);
  return out;
}
double inner_radius(Scene::Instance const& i) {
  return i.node.table("shape").table("cone").number("inner_radius", dim::length);
}

TEST(Instances, NamesGroupsAndScopes) {
  Scene const s = scene_of(baffle +
                           "  - {name: ITM, use: panel, at: [0, 0, 0], facing: [0, 0, 1], material: hr, r: n*5 cm}\n"
                           "  - {name: baffles, use: baffle, aperture: aperture, body: tube, repeat: {count: n, along: "
                           "z, from: 50 m, to: L - 10 m}}\n"
                           "  - {name: tube, shape: {cylinder: {radius: L}}}\n");
  EXPECT_THAT(names(s), ElementsAre("ITM", "baffles[0]/cone", "baffles[0]/rim", "baffles[1]/cone", "baffles[1]/rim",
                                    "baffles[2]/cone", "baffles[2]/rim", "tube"));
  EXPECT_THAT(groups(s), ElementsAre("ITM", "baffles/cone", "baffles/rim", "baffles/cone", "baffles/rim",
                                     "baffles/cone", "baffles/rim", "tube"));
  EXPECT_THAT(offsets(s), ElementsAre(0, 50, 50, 70, 70, 90, 90, 0));
  EXPECT_EQ(s.instances()[0].repeat_axis, -1);
  EXPECT_EQ(s.instances()[1].repeat_axis, 2);
  EXPECT_DOUBLE_EQ(s.instances()[0].node.table("shape").table("disk").number("outer_radius", dim::length), 0.15);
  EXPECT_EQ(s.instances()[0].frames.size(), 1u);
  EXPECT_EQ(s.instances()[0].placement.word("material"), "hr");
  EXPECT_DOUBLE_EQ(inner_radius(s.instances()[1]), 0.42) << "the placing entry speaks in the outer scope";
  EXPECT_EQ(s.instances()[1].placement.word("body"), "tube");
  EXPECT_TRUE(s.instances()[1].frames.empty());
  EXPECT_EQ(s.instances()[7].node.table("shape").table("cylinder").number("radius", dim::length), 100);
  // Keys of the structure are known; only a real mistake is left.
  for (auto const& i : s.instances()) {
    for (char const* key : {"at", "facing", "rotate", "body", "material", "side", "shape"}) i.placement.has(key);
    i.placement.refuse_unknown("scene entry");
  }
  EXPECT_NO_THROW(s.throw_if_problems());
}

TEST(Instances, DefaultsOfPartsSeeTheModel) {
  Scene const s =
      scene_of(baffle + "  - {name: a, use: baffle}\n  - {name: b, use: baffle, half: 1 m, at: [0, 0, far0]}\n");
  EXPECT_DOUBLE_EQ(inner_radius(s.instances()[0]), 0.4);
  EXPECT_DOUBLE_EQ(inner_radius(s.instances()[2]), 1);
  EXPECT_NO_THROW(s.throw_if_problems()) << "far0 is read by nobody here";
  s.instances()[2].placement["at"].as_numbers(dim::length, 3);
  EXPECT_THROW(s.throw_if_problems(), InputError);
}

TEST(Instances, MistakesInAnEntryAreLeftToTheReader) {
  Scene const s = scene_of(baffle + "  - {name: a, use: baffle, apperture: 1 m}\n");
  s.instances()[0].placement.refuse_unknown("scene entry");
  try {
    s.throw_if_problems();
    FAIL();
  } catch (InputError const& e) {
    EXPECT_THAT(e.what(), HasSubstr("unknown key 'apperture' in scene entry"));
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'aperture'?"));
  }
}

TEST(Instances, BuiltInMirror) {
  Scene const s = scene_of(
      "scene:\n  - {name: flat, use: mirror}\n  - {name: ITM, use: mirror, radius_of_curvature: 1420 m, radius: 10 "
      "cm}\n"
      "  - {name: convex, use: mirror, radius_of_curvature: -2 km}\n");
  auto const cap = [&](std::size_t i, char const* key, Dimension d) {
    return s.instances()[i].node.table("shape").table("cap").number(key, d);
  };
  EXPECT_EQ(cap(0, "curvature", dim::per_metre), 0);
  EXPECT_DOUBLE_EQ(cap(0, "outer_radius", dim::length), 0.175);
  EXPECT_DOUBLE_EQ(cap(1, "curvature", dim::per_metre), 1 / 1420.0);
  EXPECT_DOUBLE_EQ(cap(1, "outer_radius", dim::length), 0.1);
  EXPECT_DOUBLE_EQ(cap(2, "curvature", dim::per_metre), -1 / 2000.0);
  EXPECT_NO_THROW(s.throw_if_problems());
  EXPECT_THAT(groups(s), ElementsAre("flat", "ITM", "convex"));
  EXPECT_EQ(s.files().size(), 1u) << "built-in parts are not a file of the model";
}

std::vector<double> repeated(std::string const& repeat) {
  Scene const s = scene_of(baffle + "  - {name: p, use: panel, repeat: " + repeat + "}\n");
  s.throw_if_problems();
  return offsets(s);
}

TEST(Instances, FormsOfRepeat) {
  EXPECT_THAT(repeated("{count: 3, along: x, from: 1 m, to: 2 m}"), ElementsAre(1, 1.5, 2));
  EXPECT_THAT(repeated("{count: 3, along: z, pitch: 25 cm}"), ElementsAre(0, 0.25, 0.5));
  EXPECT_THAT(repeated("{count: 2, along: y, pitch: 1 m, from: -L}"), ElementsAre(-100, -99));
  EXPECT_THAT(repeated("{at: [1 m, 5 m, L], along: z}"), ElementsAre(1, 5, 100));
  EXPECT_THAT(repeated("{count: 1, along: z, from: 2 m, to: 2 m}"), ElementsAre(2));
  Scene const split =
      scene_of(baffle + "  - {name: b, use: baffle, split: true, repeat: {count: 2, along: z, from: 0, to: 1 m}}\n");
  EXPECT_THAT(groups(split), ElementsAre("b[0]/cone", "b[0]/rim", "b[1]/cone", "b[1]/rim"));
  Scene const plain =
      scene_of(baffle + "  - {name: b, shape: {disk: {r: 1 m}}, repeat: {count: 2, along: x, from: 0, to: 1 m}}\n");
  EXPECT_THAT(names(plain), ElementsAre("b[0]", "b[1]"));
  EXPECT_EQ(plain.instances()[1].repeat_axis, 0);
}

TEST(Instances, RepeatFromATable) {
  auto const read = [](std::string const& csv) {
    return FileTexts{
        {"arm.yaml", "straytrace: 1\n" + baffle + "  - {name: b, use: baffle, half: 3 m, repeat: {table: b.csv}}\n"},
        {"b.csv", csv}};
  };
  Scene const s = scene_of(read("# positions\nz [m], aperture [cm]\r\n\n10, 50\r\n 20.5 ,\t60\n"));
  ASSERT_NO_THROW(s.throw_if_problems());
  EXPECT_THAT(names(s), ElementsAre("b[0]/cone", "b[0]/rim", "b[1]/cone", "b[1]/rim"));
  EXPECT_THAT(offsets(s), ElementsAre(10, 10, 20.5, 20.5));
  EXPECT_DOUBLE_EQ(s.instances()[3].node.table("shape").table("edge").number("radius", dim::length), 0.3);
  EXPECT_DOUBLE_EQ(inner_radius(s.instances()[2]), 3);

  struct Case {
    char const *csv, *what;
  };
  std::vector<Case> const cases{
      {"z [m], aperture [cm]\n1,5, 50\n", "b.csv:2:1: error: 3 values, but the header has 2 columns"},
      {"z [m], aperture [cm]\n1,5, 50\n", "use decimal points, not decimal commas: 1.5, not 1,5"},
      {"z [m]; aperture [cm]\n1; 50\n", "b.csv:1:6: error: columns are separated by ';'"},
      {"z, aperture [cm]\n1, 50\n", "b.csv:1:1: error: column 'z' is a length and needs its unit"},
      {"z [s], aperture [cm]\n1, 50\n", "b.csv:1:1: error: column 'z' is a length, its unit is a time"},
      {"z [m], x [m]\n1, 50\n", "b.csv:1:8: error: a second position column"},
      {"aperture [cm]\n50\n", "b.csv:1:1: error: no position column"},
      {"z [m], aperure [cm]\n1, 50\n", "did you mean 'aperture'?"},
      {"z [m], aperture [s]\n1, 50\n", "b.csv:1:8: error: column 'aperture' is a length, its unit is a time"},
      {"z [m], aperture [zorks]\n1, 50\n", "b.csv:1:8: error: cannot read the column name"},
      {"z [m], aperture [cm]\n1, nan\n", "b.csv:2:4: error: 'nan' is not a number"},
      {"z [m], aperture [cm]\n1, 50 cm\n", "b.csv:2:4: error: '50 cm' is not a number"},
      {"z [m], aperture [cm]\n", "b.csv: error: the table has no rows"},
      {"", "b.csv: error: the table has no rows"},
      {"z [m], aperure [cm]\n1, 5, 50\n", "did you mean 'aperture'?"},  // beside the error of the row
      {"z [m], z [m]\n1, 2\n", "column 'z' appears twice"},
      {"z [m], half [m], half [m]\n1, 2, 3\n", "column 'half' appears twice"},
  };
  for (Case const& c : cases) EXPECT_THAT(errors_of(read(c.csv)), HasSubstr(c.what)) << c.csv;
}

// A value out of range is printed with the row or the line that sets it.
TEST(Instances, ValuesOutOfRangeNameTheirOrigin) {
  auto const said = [](std::string const& entry, std::vector<std::string> const& overrides, std::size_t instance) {
    FileTexts const texts{{"arm.yaml", "straytrace: 1\n" + baffle + "  - {name: b, use: panel, " + entry + "}\n"},
                          {"b.csv", "z [m], r [cm]\n1, 5\n2, -5\n"}};
    Scene const s = scene_of(texts, overrides);
    Node const disk = s.instances().at(instance).node.table("shape").table("disk");
    disk.number("outer_radius", dim::length, required, 0, 1);
    return said_by(s);
  };
  std::string const table = "repeat: {table: b.csv}", range = "write a value between 0 and 1 m";
  EXPECT_EQ(said(table, {}, 0), "");
  EXPECT_THAT(said(table, {}, 1), HasSubstr("^ it is -0.05 m (line 3 of b.csv): " + range));
  EXPECT_THAT(said("r: -3 cm", {}, 0), HasSubstr("^ it is -0.03 m (line 11): " + range));
  EXPECT_THAT(said("r: L", {"L=-3km"}, 0), HasSubstr("^ it is -3000 m (line 11): " + range));
}

TEST(Instances, Errors) {
  struct Case {
    char const *entry, *what;
  };
  std::vector<Case> const cases{
      {"{use: panel}", "key 'name' (text) is missing"},
      {"{name: a/b, use: panel}", "'a/b' is not a valid name"},
      {"{name: 'a*', use: panel}", "'a*' is not a valid name"},
      {"{name: a}", "entry 'a' has neither 'use' nor 'shape' nor 'file'"},
      {"{name: a, use: panel, shape: {disk: {}}}", "entry 'a' has more than one of"},
      {"{name: a, use: pane}", "did you mean 'panel'?"},
      {"{name: a, use: zork}", "part 'zork' is not defined"},
      {"{name: a, use: panel, r: 5}", "'r' is a length, got \"5\" without a unit"},
      {"{name: a, use: panel, r: [1 m]}", "parameter 'r' must be one quantity"},
      {"{name: a, use: panel, repeat: 5}", "'repeat' needs a table of keys"},
      {"{name: a, use: panel, repeat: {count: 2.5, along: z, from: 0, to: 1 m}}",
       "'count' must be a whole number, got \"2.5\""},
      {"{name: a, use: panel, repeat: {count: 0, along: z, from: 0, to: 1 m}}", "'count' must be between 1 and"},
      {"{name: a, use: panel, repeat: {count: -3, along: z, from: 0, to: 1 m}}", "'count' must be between 1 and"},
      {"{name: a, use: panel, repeat: {count: 1e9, along: z, from: 0, to: 1 m}}", "'count' must be between 1 and"},
      {"{name: a, use: panel, repeat: {count: 2 m, along: z, from: 0, to: 1 m}}", "'count' is a plain number"},
      {"{name: a, use: panel, repeat: {count: 2, along: z, from: 3 m, to: 1 m}}", "'to' lies before 'from'"},
      {"{name: a, use: panel, repeat: {count: 1, along: z, from: 0, to: 1 m}}", "a single instance cannot be at both"},
      {"{name: a, use: panel, repeat: {count: 2, along: w, from: 0, to: 1 m}}", "'along' cannot be \"w\""},
      {"{name: a, use: panel, repeat: {count: 2, from: 0, to: 1 m}}", "key 'along' (a choice) is missing"},
      {"{name: a, use: panel, repeat: {count: 2, along: z, pitch: 0}}", "'pitch' must be positive"},
      {"{name: a, use: panel, repeat: {count: 2, along: z, pitch: 1 m, to: 5 m}}",
       "unknown key 'to' in this form of 'repeat'"},
      {"{name: a, use: panel, repeat: {cuont: 2, along: z, from: 0, to: 1 m}}", "did you mean 'count'?"},
      {"{name: a, use: panel, repeat: {at: [], along: z}}", "'at' needs between 1 and"},
      {"{name: a, use: panel, repeat: {at: [1 m, 1,5 m], along: z}}", "'1,5 m' has a decimal comma"},
      {"{name: a, use: panel, repeat: {at: [0,5 m], along: z}}", "write '0.5 m'; two values are '0 m, 5 m'"},
      {"{name: a, use: panel, repeat: {table: no.csv}}", "cannot read file 'no.csv'"},
      {"just text", "an entry of 'scene' is a table of keys"},
  };
  for (Case const& c : cases) EXPECT_THAT(errors_of(baffle + "  - " + c.entry + "\n"), HasSubstr(c.what)) << c.entry;
  EXPECT_THAT(errors_of(baffle + "  - {name: a, use: zork}\n"), HasSubstr("add 'include: [library/parts.yaml]'"));
  EXPECT_THAT(errors_of(baffle + "  - {name: a, use: panel}\n  - {name: a, use: baffle}\n"),
              HasSubstr("name 'a' is used twice in 'scene'"));
  EXPECT_EQ(errors_of(baffle + "  - {name: a, use: panel}\n  - {name: b, use: baffle}\n"), "");
}

TEST(Instances, NumbersOfInstancesAreBounded) {
  auto const count = [](std::string const& n) {
    return errors_of(baffle + "  - {name: a, use: panel, repeat: {count: " + n + ", along: z, pitch: 1 mm}}\n");
  };
  EXPECT_EQ(count("20000"), "");
  EXPECT_THAT(count("1000001"), HasSubstr("'count' must be between 1 and 1e+06"));
  EXPECT_THAT(errors_of(baffle + "  - {name: a, use: baffle, repeat: {count: 600000, along: z, pitch: 1 mm}}\n"),
              HasSubstr("the scene has more than 1000000 instances"));
  std::string parts = "parts:\n  p0: {faces: {a: {shape: {disk: {}}}}}\n";
  for (int i = 1; i < 8; ++i) {
    parts += "  p" + std::to_string(i) + ":\n    faces:\n";
    for (int f = 0; f < 20; ++f) parts += "      f" + std::to_string(f) + ": {use: p" + std::to_string(i - 1) + "}\n";
  }
  EXPECT_THAT(errors_of(parts + "scene: [{name: x, use: p7}]\n"),
              HasSubstr("the scene has more than 1000000 instances"))
      << "20^7 faces";
  std::string circle = "parts:\n";
  for (int i = 0; i < 7; ++i) {
    circle += "  p" + std::to_string(i) + ":\n    faces:\n";
    for (int f = 0; f < 70; ++f)
      circle += "      f" + std::to_string(f) + ": {use: p" + std::to_string((f + i) % 7) + "}\n";
  }
  EXPECT_THAT(errors_of(circle + "scene: [{name: x, use: p0}, {name: y, use: p1}]\n"), HasSubstr("contains itself"));
}

TEST(Instances, ResolvedTextIsEquivalentAndReadable) {
  Scene const s = scene_of(
      baffle +
          "  - {name: b, use: baffle, aperture: aperture, repeat: {count: 2, along: z, from: 50 m, to: L - 10 m}}\n",
      {"aperture=60 cm"});
  std::string const text = s.resolved();
  EXPECT_THAT(text, HasSubstr("  aperture: 0.6 m\n"));
  EXPECT_THAT(
      text, HasSubstr("  - {name: \"b[1]/cone\", group: b/cone, z: 90 m, aperture: 0.6 m, far: 100 m, half: 0.3 m}\n"));
  // Without the list of instances it is a model again, with the same parameters.
  std::string const model = text.substr(0, text.find("instances:"));
  Scene const again = scene_of(FileTexts{{"arm.yaml", model}});
  ASSERT_NO_THROW(again.throw_if_problems());
  EXPECT_EQ(names(again), names(s));
  EXPECT_EQ(offsets(again), offsets(s));
}

}  // namespace
}  // namespace straytrace::test
