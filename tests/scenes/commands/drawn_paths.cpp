// SPDX-License-Identifier: BSD-3-Clause
// Drawn paths that represent all paths: named wherever their noise is shown.
#include <nlohmann/json.hpp>

#include <optional>

#include "results/results.hpp"
#include "scenes/program.hpp"
#include "session/open_run.hpp"
#include "session/report_page.hpp"
#include "session/session.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing::app_drawn_paths {
namespace {

using namespace results;
using namespace session;
using namespace trace;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

// The Virgo arm with a slow line along the tube and a strong tone across: paths differ in the strength of the tone by
// decades, and fringes fall by decades within a bin.
std::string swaying_arm() {
  std::string text = text_of(written_arm);
  std::size_t const from = text.find("      z:\n"), to = text.find("  towers: {motion");
  EXPECT_TRUE(from < to && to != text.npos);
  return text
      .replace(from, to - from,
               "      z: {line: {at: 0.5 Hz, width: 0.1 Hz, rms: 0.2 um rms}}\n"
               "      x: {sine: {amplitude: tone peak, frequency: 0.9 Hz}}\n"
               "      y: still\n")
      .replace(text.find("params:\n"), 8, "params:\n  tone: 1 mm\n");
}

char const* const said = "drawn at random among paths of like strength";

bool has(std::vector<std::string> const& warnings) {
  return std::any_of(warnings.begin(), warnings.end(), [](std::string const& w) { return w.find(said) != w.npos; });
}

TEST(DrawnPaths, AreNamedWhereverTheirNoiseIsShown) {
  Folder const folder;
  std::string const scene = folder / "arm.yaml", run = folder / "out/run.h5";
  write_text(scene, swaying_arm());
  Finished const made = straytrace({"run", scene, "--histories", "32768", "-o", folder / "out"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr(said));
  EXPECT_THAT(text_of(folder / "out/report.txt"), HasSubstr(said));
  RunFile const file = read_run(run);
  ASSERT_TRUE(file.noise);
  EXPECT_TRUE(has(file.noise->warnings));

  Finished const noise = straytrace({"noise", run, "--format", "json"});
  EXPECT_THAT(noise.err, HasSubstr(said));
  EXPECT_TRUE(has(Json::parse(noise.out)["warnings"].get<Words>()));

  Finished const budget = straytrace({"budget", run, "--format", "json"});
  EXPECT_THAT(budget.err, HasSubstr(said));
  EXPECT_TRUE(has(Json::parse(budget.out)["warnings"].get<Words>()));

  Finished const scan = straytrace({"scan", scene, "tone=1e-6 mm,1 mm", "--histories", "32768", "--format", "json"});
  ASSERT_EQ(scan.code, 0) << scan.err;
  EXPECT_THAT(scan.err, HasSubstr("tone=1 mm"));
  EXPECT_THAT(scan.err, HasSubstr(said));
  Json const points = Json::parse(scan.out)["points"];
  EXPECT_FALSE(has(points[0]["warnings"].get<Words>())) << "control: a weak tone is shared well";
  EXPECT_TRUE(has(points[1]["warnings"].get<Words>()));

  Finished const answer = straytrace({"scan", run, "--invert", "brdf(baffle_steel)"});
  EXPECT_THAT(answer.err, HasSubstr(said));
  EXPECT_THAT(straytrace({"noise", run, "--quiet"}).err, Not(HasSubstr(said)));
}

// Histories are traced again only for pictures of paths; everything else on a page is in the run file.
TEST(DrawnPaths, AloneAreTracedAgain) {
  Folder const folder;
  Finished const r = straytrace({"trace", virgo_arm, "-o", folder / "run.h5", "--histories", "4096", "--quiet"});
  ASSERT_EQ(r.code, 0) << r.err;
  RunFile const file = read_run_file(folder / "run.h5");
  Model model = model_of(file);
  model.world.block_size = file.trace.coupling.block_size;
  RunContent const content = file.content();
  PathTable const table = table_for(file.trace.coupling, content.noise, model);
  int asked = 0;
  std::optional<SteeredWorld> steered;
  TracedAgain const traced = [&]() -> SteeredWorld const& {
    ++asked;
    if (!steered) steered = steer(model.world);
    return *steered;
  };
  ReportWanted wanted;
  wanted.pictures = {"budget", "wave", "ghosts", "materials", "convergence"};
  report_page(content, table, model, traced, wanted, {});
  EXPECT_EQ(asked, 0);
  ViewWanted view;
  view.rays = view.rows = 0;
  view_page(model, traced, &content, &table, view);
  EXPECT_EQ(asked, 0);
  wanted.pictures = {"scene"};  // control: with paths
  report_page(content, table, model, traced, wanted, {});
  EXPECT_GT(asked, 0);
}

}  // namespace
}  // namespace straytrace::testing::app_drawn_paths
