// SPDX-License-Identifier: BSD-3-Clause
// Data read from STEP files: faces by kind, names, colours, placements, units; and the errors for bad files.
#include <algorithm>

#include "step/support.hpp"

namespace straytrace::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names(CadFile const& f) {
  std::vector<std::string> out;
  for (CadFilePart const& p : f.parts) out.push_back(p.name + " " + p.colour);
  return out;
}
void expect_box(Box const& box, Vec3 lower, Vec3 upper, double tolerance = 1e-9) {
  EXPECT_LT(length(box.lower - lower), tolerance) << box.lower.x << ' ' << box.lower.y << ' ' << box.lower.z;
  EXPECT_LT(length(box.upper - upper), tolerance) << box.upper.x << ' ' << box.upper.y << ' ' << box.upper.z;
}

TEST(step_files, solids_keep_names_colours_and_kinds_in_every_unit_and_schema) {
  for (auto const& [unit, metres, schema] :
       {std::tuple{"MM", 1e-3, "AP203"}, {"INCH", 0.0254, "AP214IS"}, {"M", 1.0, "AP242DIS"}}) {
    CadFile const f = converted(sample(step::add_solids, unit, schema));
    EXPECT_THAT(names(f), ElementsAre("box #ff0000", "rod #00ff00", "cone #0000ff", "ball #202020", "ring #808080"));
    EXPECT_TRUE(f.unit_stated);
    EXPECT_DOUBLE_EQ(f.unit, metres);
    expect_box(f.box, {-0.02, -0.025, -0.015}, {0.425, 0.025, 0.05});
    std::map<Carrier, int> kinds;
    for (CadFilePart const& p : f.parts)
      for (CadFileFace const& face : p.faces) ++kinds[face.carrier];
    EXPECT_THAT(kinds,
                ElementsAre(std::pair{Carrier::plane, 10}, std::pair{Carrier::cylinder, 1}, std::pair{Carrier::cone, 1},
                            std::pair{Carrier::sphere, 1}, std::pair{Carrier::torus, 1}));
    CadFileFace const ball = f.parts[3].faces[0];
    EXPECT_NEAR(ball.radius, 0.015, 1e-13);  // the digits of the file
    EXPECT_TRUE(ball.natural);
  }
}

// Areas of the closed forms; all normals look outwards.
TEST(step_files, areas_of_solids_are_exact) {
  Built const b = built({{"s.step", sample(step::add_solids)}}, "file: s.step, units: from_file, material: grey");
  ASSERT_EQ(b.errors, "");
  std::map<std::string, double> area;
  WorldView const v = b.world.view();
  for (Surface const& s : b.world.surfaces())
    area[b.world.groups()[s.group.value]] += v.shapes.visit(s.shape, [](auto const& shape) { return shape.area(); });
  double const slant = std::hypot(0.015, 0.03);
  std::map<std::string, double> const exact = {
      {"bench/box", 2 * (0.04 * 0.03 + 0.04 * 0.02 + 0.03 * 0.02)},
      {"bench/rod", 2 * pi * 0.01 * (0.01 + 0.05)},
      {"bench/cone", pi * (0.02 * 0.02 + 0.005 * 0.005 + (0.02 + 0.005) * slant)},
      {"bench/ball", 4 * pi * 0.015 * 0.015},
      {"bench/ring", 4 * pi * pi * 0.02 * 0.005}};
  for (auto const& [name, value] : exact) EXPECT_NEAR(area[name], value, 5e-9 * value) << name;
}

TEST(step_files, assemblies_place_parts_in_parts) {
  CadFile const f = converted(sample(step::add_nested));
  EXPECT_THAT(names(f), ElementsAre("left tower/dump #202020", "left tower/dump_2 #202020", "plate "));
  // The dump, 10 x 20 x 30 mm, turned by 90 degrees at x = 1 m: 50 mm along y. The second is turned by 180 degrees.
  Built const b = built({{"n.step", sample(step::add_nested)}},
                        "file: n.step, units: from_file, surfaces: {dump: black, default: grey}");
  ASSERT_EQ(b.errors, "");
  std::map<std::string, Box> boxes;
  WorldView const v = b.world.view();
  for (Surface const& s : b.world.surfaces())
    boxes[b.world.groups()[s.group.value]].add(v.shapes.visit(s.shape, [](auto const& x) { return x.bounds(); }));
  expect_box(boxes["bench/left tower/dump"], {0.99, 0.045, 0}, {1.01, 0.055, 0.03});
  expect_box(boxes["bench/left tower/dump_2"], {0.995, -0.01, 0.1}, {1.005, 0.01, 0.13});
  expect_box(boxes["bench/plate"], {-0.2, -0.15, -0.01}, {0.2, 0.15, 0});
}

TEST(step_files, faces_keep_their_own_colour) {
  CadFile const f = converted(sample(step::add_crossing));
  ASSERT_EQ(f.parts.size(), 2u);
  EXPECT_EQ(f.parts[0].name, f.parts[1].name);
  EXPECT_EQ(std::min(f.parts[0].colour, f.parts[1].colour), "#102030");
  EXPECT_EQ(std::min(f.parts[0].faces.size(), f.parts[1].faces.size()), 1u);
}

TEST(step_files, free_surfaces_become_triangles_within_the_chord) {
  CadFile const f = converted(sample(step::add_sheet));
  ASSERT_EQ(f.parts.size(), 1u);
  EXPECT_EQ(f.parts[0].freeform, 1u);
  EXPECT_EQ(f.parts[0].faces.size(), 5u);
  EXPECT_GT(f.parts[0].triangles.size(), 100u);
}

// A whole file with `from` written as `to`, or without its end.
std::string with(std::string text, std::string const& from, std::string const& to) {
  std::size_t const at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}
std::string fault(std::string const& step) {
  folder();
  StepConversion const made = convert_step("x.step", step);
  EXPECT_EQ(made.text, "");
  EXPECT_NE(made.fault.suggestion, "") << made.fault.what;
  return made.fault.what;
}

TEST(step_files, bad_files_are_errors_with_a_reason) {
  std::string const good = sample(step::add_solids);
  EXPECT_THAT(fault("solid cube\nendsolid\n"), HasSubstr("not a STEP file"));
  EXPECT_THAT(fault(good.substr(0, good.size() / 2)), HasSubstr("cut off"));
  EXPECT_THAT(fault(with(good, "DATA;", std::string("DATA;\0", 6))), HasSubstr("contains a zero byte"));
  EXPECT_THAT(fault(with(good, "AUTOMOTIVE_DESIGN", "PLANT_SPATIAL")), HasSubstr("'PLANT_SPATIAL'"));
  EXPECT_THAT(fault(sample(step::add_wire)), HasSubstr("holds no faces"));
  EXPECT_NE(fault("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AP214'));\nENDSEC;\nDATA;\n#1=GARB(;\nEND-ISO-10303-21;\n"),
            "");
}

TEST(step_files, converted_files_are_checked) {
  folder();
  std::string const good = convert_step("s.step", sample(step::add_solids)).text;
  auto const what = [](std::string const& text) {
    CadFile file;
    return read_cad_file(text, file).what;
  };
  EXPECT_EQ(what(good), "");
  EXPECT_THAT(what(good.substr(0, good.size() - 20)), HasSubstr("damaged"));
  EXPECT_THAT(what("{\"asset\": {}}"), HasSubstr("not CAD geometry"));
  EXPECT_THAT(what(with(good, "\"straytrace_cad\":1", "\"straytrace_cad\":2")), HasSubstr("version 2"));
  EXPECT_THAT(what(with(good, "\"kind\":\"plane\"", "\"kind\":\"plain\"")), HasSubstr("'plain' is not a kind"));
  EXPECT_THAT(what(with(good, "\"radius\":0.015", "\"radius\":-0.015")), HasSubstr("not positive"));
}

}  // namespace
}  // namespace straytrace::test
