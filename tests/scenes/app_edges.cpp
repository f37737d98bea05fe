// SPDX-License-Identifier: BSD-3-Clause
// Rims of baffles and apertures as a user meets them (physics.md 8.5, R2.27).
#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

std::string const et_edges = source_folder + "/examples/et_hf_edges.yaml";

TEST(EdgesCommand, RowsOfTheirOwnKind) {
  Folder const folder;
  Finished const run = straytrace({"run", et_edges, "-o", folder / "out", "-p", "baffles_per_half=3", "-p",
                                   "miscentring=1mm", "--histories", "4e4", "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("ITM·S > baffles_in·E > ETM·S"));
  EXPECT_THAT(run.out, HasSubstr("upper bound: "));
  std::string const report = text_of(folder / "out/report.txt");
  EXPECT_THAT(report, HasSubstr("3 rims, powers added"));
  EXPECT_THAT(report, HasSubstr("routes of kind edge, upper bounds"));
  std::string const csv = text_of(folder / "out/paths.csv");
  EXPECT_THAT(csv, HasSubstr(",sampled_on,kind,statement\n"));
  EXPECT_THAT(csv, HasSubstr(",itself,scattered,\n"));
  EXPECT_THAT(csv, HasSubstr(",itself,edge,"));
  EXPECT_THAT(straytrace({"paths", folder / "out/run.h5", "--format", "json"}).out, HasSubstr("\"kind\": \"edge\""));
  // A run file projects them without tracing or building anything again.
  EXPECT_THAT(straytrace({"noise", folder / "out/run.h5"}).out, HasSubstr("baffles_end·E"));
  std::string const reader = "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='" + source_folder +
                             "/python' timeout 60 /usr/bin/python3 -c \"import straytrace; r = straytrace.open('" +
                             (folder / "out/run.h5") +
                             "').routes; k = r.kind.index('edge'); assert r.sigma[k] == 0 and 'bound' in r.statement[k]"
                             " and 'scattered' in r.kind\"";
  EXPECT_EQ(std::system(reader.c_str()), 0);
}

TEST(AperturesCommand, TableAndProfile) {
  Finished const table = straytrace({"apertures", virgo_arm, "--show", "2"});
  ASSERT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("ETM     2999.8  58.018"));
  EXPECT_THAT(table.out, HasSubstr("and 72 more"));
  EXPECT_THAT(straytrace({"apertures", virgo_arm, "--format", "json"}).out, HasSubstr("\"axis_factor_far\":"));
  EXPECT_EQ(straytrace({"apertures", virgo_arm, "--profile", "ETM", "--distance", "500 m"}).code, 0);
  EXPECT_THAT(straytrace({"apertures", virgo_arm, "--profile", "ETN", "--distance", "500 m"}).err,
              HasSubstr("did you mean 'ETM'?"));
  for (char const* distance : {"500", "-1 m", "3 s"}) {
    Finished const refused = straytrace({"apertures", virgo_arm, "--profile", "ETM", "--distance", distance});
    EXPECT_EQ(refused.code, 2) << distance;
    EXPECT_THAT(refused.err, HasSubstr("write for example --distance"));
  }
  EXPECT_EQ(straytrace({"apertures", virgo_arm, "--profile", "ETM"}).code, 2);
}

}  // namespace
}  // namespace straytrace::testing
