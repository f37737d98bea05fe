// SPDX-License-Identifier: BSD-3-Clause
// The structure of parts, and parts inside parts (docs/reference/scene.md).
#include "unit/scene/support.hpp"

namespace straytrace::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Parts, Errors) {
  struct Case {
    char const *part, *what;
  };
  std::vector<Case> const cases{
      {"{params: {r: 1 m}}", "part 'p' has no faces"},
      {"{faces: {}}", "part 'p' has no faces"},
      {"{faces: {a: {material: x}}}", "face 'a' has neither 'use' nor 'shape' nor 'file'"},
      {"{faces: {a: 5}}", "face 'a' needs a table of keys"},
      {"{faces: {a: {shape: {disk: {}}}}, prams: {r: 1 m}}", "unknown key 'prams' in part 'p'"},
      {"{faces: {a: {shape: {disk: {}}}}, params: {body: 1 m}}", "'body' is a key of every scene entry"},
      {"{faces: {a: {shape: {disk: {}}}}, params: {h: 1 m}}", "'h' is a unit or a function"},
      {"{faces: {a: {shape: {disk: {}}}}, params: {r: r}}", "parameter 'r' depends on itself"},
      {"5", "part 'p' needs a table with 'faces'"},
  };
  for (Case const& c : cases)
    EXPECT_THAT(errors_of(std::string("parts: {p: ") + c.part + "}\nscene:\n  - {name: a, use: p}\n"),
                HasSubstr(c.what))
        << c.part;
}

TEST(Parts, InsideParts) {
  std::string const bench =
      "params: {d: 1 m}\n"
      "parts:\n"
      "  trap: {params: {r: 1 cm}, faces: {front: {shape: {disk: {outer_radius: r}}}, back: {shape: {disk: "
      "{outer_radius: 2*r}}}}}\n"
      "  bench:\n"
      "    params: {size: 5 cm}\n"
      "    faces:\n"
      "      board: {shape: {disk: {outer_radius: d}}, at: [0, 0, 1 m]}\n"
      "      trap_3: {use: trap, r: size*2, at: [1 m, 0, 0], facing: [1, 0, 0], material: black}\n"
      "      m1: {use: mirror, at: [0, 1 m, 0]}\n"
      "scene:\n";
  Scene const s =
      scene_of(bench + "  - {name: NE, use: bench, at: [0, 0, d], body: table, material: bare, size: d/2}\n");
  ASSERT_NO_THROW(s.throw_if_problems());
  std::vector<std::string> names;
  for (auto const& i : s.instances()) names.push_back(i.name);
  EXPECT_THAT(names, ElementsAre("NE/board", "NE/trap_3/front", "NE/trap_3/back", "NE/m1"));
  auto const& front = s.instances()[1];
  EXPECT_EQ(front.node.table("shape").table("disk").number("outer_radius", dim::length), 1);
  ASSERT_EQ(front.frames.size(), 2u);
  EXPECT_EQ(front.frames[0]["at"].as_numbers(dim::length, 3)[2], 1);
  EXPECT_EQ(front.frames[1]["at"].as_numbers(dim::length, 3)[0], 1);
  EXPECT_EQ(front.placement.word("material"), "black");
  EXPECT_EQ(front.placement.word("body"), "table");
  EXPECT_EQ(s.instances()[3].placement.word("material"), "bare");
  EXPECT_EQ(s.instances()[0].frames.size(), 2u);

  EXPECT_THAT(errors_of("parts: {a: {faces: {f: {use: b}}}, b: {faces: {f: {use: a}}}}\nscene: [{name: x, use: a}]\n"),
              HasSubstr("part 'a' contains itself"));
  EXPECT_THAT(errors_of("parts: {a: {faces: {f: {use: mirror, repeat: {count: 2}}}}}\nscene: [{name: x, use: a}]\n"),
              HasSubstr("'repeat' inside a part is not supported"));
  EXPECT_THAT(errors_of("parts: {a: {faces: {f: {use: mirror, raduis: 1 m}}}}\nscene: [{name: x, use: a}]\n"),
              HasSubstr("did you mean 'radius'?"));
}

}  // namespace
}  // namespace straytrace::test
