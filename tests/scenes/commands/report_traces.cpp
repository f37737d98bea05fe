// SPDX-License-Identifier: BSD-3-Clause
// The pages of a run trace histories again only for pictures of paths; everything else is in the run file.
#include <optional>

#include "scenes/program.hpp"
#include "session/open_run.hpp"
#include "session/report_page.hpp"
#include "session/session.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing {
namespace {

using namespace straytrace::session;

TEST(ReportTraces, OnlyForPicturesOfPaths) {
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
}  // namespace straytrace::testing
