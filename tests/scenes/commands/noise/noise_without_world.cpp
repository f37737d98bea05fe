// SPDX-License-Identifier: BSD-3-Clause
// Commands that only project, and maps, read the run file alone: no surface, mesh or search tree is built.
#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing::app_noise_without_world {
namespace {

using ::testing::HasSubstr;

// A run of a mesh whose file, inside the run file, is then replaced by text that no mesh reader takes.
struct NoiseWithoutWorld : ::testing::Test {
  static inline std::unique_ptr<Folder> shared;
  Folder const& folder = *shared;
  std::string const whole = folder / "whole.h5", broken = folder / "broken.h5";
  static void TearDownTestSuite() { shared.reset(); }
  static void SetUpTestSuite() {
    shared = std::make_unique<Folder>();
    Folder const& folder = *shared;
    std::string const whole = folder / "whole.h5";
    std::string const scene = folder / "arm.yaml", mesh = "holder.obj";
    fs::copy_file(source_folder + "/examples/holder.obj", folder / mesh);
    write_text(scene,
               edited(text_of(written_arm), "\nscene:\n",
                      "\nscene:\n  - {name: holder, file: holder.obj, units: mm, at: [0.4 m, 0 m, 20 m], body: tube, "
                      "material: baffle_steel}\n"));
    Finished const r = straytrace({"run", scene, "-o", whole, "--histories", "4096", "--quiet"});
    ASSERT_EQ(r.code, 0) << r.err;
    RunFile run = read_run(whole);
    ASSERT_EQ(run.about.files.count(mesh), 1u);
    run.about.files.at(mesh) = "no mesh\n";
    write_run(folder / "broken.h5", run.content());
  }
};

TEST_F(NoiseWithoutWorld, ProjectsARunWhoseMeshCannotBeRead) {
  for (Words const& words : {Words{"noise"},
                             {"noise", "--format", "json"},
                             {"paths", "--csv"},
                             {"scan", "--invert", "brdf(baffle_steel)"}}) {
    auto const with = [&](std::string const& run) {
      Words all = words;
      all.insert(all.begin() + 1, run);
      all.push_back("--quiet");
      if (words.front() == "paths") all.pop_back();
      return straytrace(all);
    };
    Finished const expected = with(whole), found = with(broken);
    EXPECT_EQ(found.code, expected.code) << found.err;
    EXPECT_EQ(found.out, expected.out) << words.front();
  }
  Finished const noise = straytrace({"noise", broken, "-o", folder / "again.h5", "--quiet"});
  ASSERT_EQ(noise.code, 0) << noise.err;
  EXPECT_EQ(read_run(folder / "again.h5").noise->total.asd, read_run(whole).noise->total.asd);
}

// Negative control: a command that builds the surfaces cannot read this file.
TEST_F(NoiseWithoutWorld, CommandsThatNeedSurfacesFail) {
  Finished const view = straytrace({"view", broken, "-o", folder / "view.html"});
  EXPECT_EQ(view.code, 2);
  EXPECT_THAT(view.err, HasSubstr("error: "));
  RunFile old = read_run(broken);
  old.about.projection.reset();  // as in files of schema 1
  write_run(folder / "old.h5", old.content());
  EXPECT_EQ(straytrace({"noise", folder / "old.h5", "--quiet"}).code, 2);
}

// The file states the areas of pixels. Negative control: files before schema 2.1 do not, so that the surface is needed,
// except for angles and quadrants.
TEST(MapsWithoutWorld, OnlyMapsOfOlderFilesNeedSurfaces) {
  Folder const folder;
  fs::copy_file(source_folder + "/examples/holder.obj", folder / "holder.obj");
  std::string const text = edited(text_of(source_folder + "/examples/two_mirrors.yaml"), "\nscene:\n",
                                  "\nscene:\n  - {name: holder, file: holder.obj, units: mm, at: [0 m, 0 m, 5 m], "
                                  "body: bench, material: black}\n"),
                    without = edited(text.substr(0, text.find("  plane:\n")), "    map:", "    # map:") +
                              "trace: {histories: 4096}\n";
  auto const maps_of = [&](std::string const& name, std::string const& scene, bool older) {
    write_text(folder / (name + ".yaml"), scene);
    std::string const run_file = folder / (name + ".h5");
    Finished const traced =
        straytrace({"trace", folder / (name + ".yaml"), "-o", run_file, "--histories", "4096", "--quiet"});
    EXPECT_EQ(traced.code, 0) << traced.err;
    RunFile run = read_run(run_file);
    run.about.files.at("holder.obj") = "no mesh\n";
    if (older) run.about.map_areas.clear();
    write_run(run_file, run.content());
    return straytrace({"maps", run_file, "-o", folder / name});
  };
  Finished const angles = maps_of("angles", without, true);
  EXPECT_EQ(angles.code, 0) << angles.err;
  EXPECT_THAT(angles.out, HasSubstr("PD_angles.csv"));
  EXPECT_EQ(maps_of("pixels", text, false).code, 0);
  EXPECT_EQ(maps_of("older", text, true).code, 2);
}

}  // namespace
}  // namespace straytrace::testing::app_noise_without_world
