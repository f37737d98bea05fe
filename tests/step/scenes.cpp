// SPDX-License-Identifier: BSD-3-Clause
// Scene entries that name a STEP file: units, rules, what the run file keeps, and that no light leaks through seams.
#include "base/math/rng.hpp"
#include "scene/scene.hpp"
#include "step/support.hpp"
#include "world/build/read_files.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

TEST(step_scenes, rules_choose_by_name_path_and_colour_in_their_order) {
  std::string const step = sample(step::add_solids);
  auto const errors = [&](std::string const& rules) {
    return built({{"s.step", step}}, "file: s.step, units: from_file, surfaces: {" + rules + "}").errors;
  };
  Built const b =
      built({{"s.step", step}},
            "file: s.step, units: from_file, surfaces: {\"r*\": black, \"color #00FF00\": grey, default: grey}");
  ASSERT_EQ(b.errors, "");
  std::map<std::string, std::uint32_t> front;
  for (Surface const& s : b.world.surfaces()) front[b.world.groups()[s.group.value]] = s.front;
  EXPECT_EQ(front["bench/rod"], front["bench/ring"]);
  EXPECT_NE(front["bench/rod"], front["bench/box"]);
  EXPECT_THAT(errors("rodd: black, default: grey"), HasSubstr("did you mean 'rod'?"));
  EXPECT_THAT(errors("\"color #00ff01\": black, default: grey"), HasSubstr("did you mean 'color #00ff00'?"));
  EXPECT_THAT(errors("\"color green\": black, default: grey"), HasSubstr("is not a colour"));
  EXPECT_THAT(errors("\"r*\": black"), HasSubstr("parts of 's.step' have no material: 'box', 'cone', 'ball'"));
}

TEST(step_scenes, units_are_those_of_the_file_or_of_the_scene) {
  std::string const step = sample(step::add_solids);
  auto const with = [&](std::string const& units) {
    return built({{"s.step", step}}, "file: s.step, material: grey" + units);
  };
  EXPECT_THAT(with("").errors, HasSubstr("write units: from_file (the file says 0.001 m)"));
  EXPECT_THAT(with(", units: kg").errors, HasSubstr("'kg' is not a unit of length"));
  EXPECT_THAT(with(", units: km").warnings, HasSubstr("bounding box 445 km x 50 km x 65 km"));
  Built const inch = with(", units: in");
  EXPECT_EQ(inch.errors, "");
  WorldView const v = inch.world.view();
  Hit const hit = v.closest({{300 * 0.0254, 0, 10}, {0, 0, -1}}, {});
  EXPECT_NEAR(hit.distance, 10 - 15 * 0.0254, 1e-12);
  folder();
  std::string text = convert_step("s.step", step).text;
  text.replace(text.find("\"unit_stated\":true"), 18, "\"unit_stated\":false");
  Built const none = built({{"s.cad.json", text}}, "file: s.cad.json, units: from_file, material: grey");
  EXPECT_THAT(none.errors, HasSubstr("this file states no unit"));
}

TEST(step_scenes, kept_conversions_run_without_the_converter) {
  std::string const entry = "file: s.step, units: from_file, material: grey";
  Built const first = built({{"s.step", sample(step::add_solids)}}, entry);
  ASSERT_TRUE(first.files.contains("s.step"));
  ASSERT_TRUE(first.files.contains("s.step.cad.json"));
  ::setenv("STRAYTRACE_STEP", "/nowhere/straytrace-step", 1);
  Built const again = built(first.files, entry);
  Built const control = built({{"s.step", first.files.at("s.step")}}, entry);
  ::setenv("STRAYTRACE_STEP", STRAY_PROGRAM "-step", 1);
  EXPECT_EQ(again.errors, "");
  EXPECT_EQ(again.world.fingerprint(), first.world.fingerprint());
  EXPECT_THAT(control.errors, HasSubstr("need the program straytrace-step, which is neither next to"));
  EXPECT_THAT(control.errors, HasSubstr("scripts/setup"));
}

// A machine that lost its power may leave a part of what was kept: it is converted again.
TEST(step_scenes, damaged_conversions_are_repeated) {
  std::string const step = sample(step::add_solids), text = convert_step("s.step", step).text;
  for (auto const& entry : fs::recursive_directory_iterator(folder() / "cache"))
    if (entry.is_regular_file()) fs::resize_file(entry.path(), 100);
  EXPECT_EQ(convert_step("s.step", step).text, text);
}

// Rays from within the solid towards its edges: light that meets nothing has passed a seam.
int leaks(CadFile const& file, double shrink) {
  World world;
  std::vector<Vec3> edges;
  std::uint32_t const optic = world.add_optic({});
  BodyId const body = world.add_body("b", {});
  GroupId const group = world.add_group("g");
  for (CadFilePart const& part : file.parts)
    for (CadFileFace f : part.faces) {
      for (ChartLoop& loop : f.loops)
        for (ChartCorner& c : loop) {
          c.x *= 1 - shrink;
          c.y *= 1 - shrink;
        }
      PlacedCadShape const placed = cad_shape(f, 1, world.storage);
      std::visit(
          [&](auto shape) {
            shape.place(placed.frame);
            world.add_surface(shape, optic, optic, body, group);
            if constexpr (std::is_same_v<decltype(shape), CadFace>)
              for (ChartLoop const& loop : f.loops)
                for (std::size_t i = 0; i < loop.size(); ++i) {
                  ChartCorner const p = loop[i], q = loop[(i + 1) % loop.size()];
                  for (double s : {0.0, 0.3, 0.7})
                    edges.push_back(shape.at(p.x + s * (q.x - p.x), p.y + s * (q.y - p.y)));
                }
          },
          placed.shape);
    }
  world.finish();
  WorldView const v = world.view();
  Rng rng(3, 0, 0, Stream::source);
  int lost = 0;
  for (Vec3 const& edge : edges)
    for (int i = 0; i < 20; ++i) {
      Vec3 const from{0.045 + 0.002 * rng.uniform(), -0.035, 0.005};  // a solid corner of step::add_crossing
      Vec3 const aim = edge + 1e-7 * Vec3{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
      lost += !v.closest({from, unit(aim - from)}, {}).surface.valid();
    }
  return lost;
}

TEST(step_scenes, no_light_passes_the_seams) {
  CadFile const file = converted(sample(step::add_crossing));
  EXPECT_EQ(leaks(file, 0), 0);
  EXPECT_GT(leaks(file, 1e-4), 0) << "the control with faces that are a little too small";
}

}  // namespace
}  // namespace straytrace::test
