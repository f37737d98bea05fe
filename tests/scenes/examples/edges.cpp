// SPDX-License-Identifier: BSD-3-Clause
// Inner edges of baffles and apertures as a user meets them (docs/theory/diffraction.md, R2.27).
#include <set>

#include "scenes/answers.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string const et_edges = source_folder + "/examples/et_hf_edges.yaml";

TEST(EdgesCommand, RowsOfTheirOwnKind) {
  Folder const folder;
  Finished const run = straytrace({"run", et_edges, "-o", folder / "out", "-p", "first_baffle=4000m", "-p",
                                   "miscentring=1mm", "--histories", "4e4", "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("ITM·S > baffles_in·E > ETM·S"));
  EXPECT_THAT(run.out, HasSubstr("upper bound: "));
  std::string const report = text_of(folder / "out/report.txt");
  EXPECT_THAT(report, HasSubstr("3 edges, powers add, because"));
  EXPECT_THAT(report, HasSubstr("routes of kind edge, upper bounds"));
  std::string const csv = text_of(folder / "out/paths.csv");
  EXPECT_THAT(csv, HasSubstr(",sampled_on,kind,statement,h_10Hz_input_low,h_10Hz_input_high,"));
  EXPECT_THAT(csv, HasSubstr(",itself,scattered,,"));
  EXPECT_THAT(csv, HasSubstr(",itself,edge,"));
  EXPECT_THAT(straytrace({"paths", folder / "out/run.h5", "--format", "json"}).out, HasSubstr("\"kind\": \"edge\""));
  // An upper bound is marked as such, without further digits, wherever the number is printed.
  std::string const last = run.out.substr(run.out.rfind('\n', run.out.size() - 2) + 1);
  EXPECT_THAT(last, HasSubstr("stray light h = at most "));
  EXPECT_THAT(last, Not(HasSubstr("±")));
  EXPECT_THAT(last, Not(::testing::ContainsRegex("[0-9]\\.[0-9]{2,}e")));
  EXPECT_THAT(report.substr(0, report.find("Where the light went")), HasSubstr("at most"));
  EXPECT_THAT(text_of(folder / "out/report.html"), HasSubstr("\"bound\":true"));
  EXPECT_THAT(text_of(folder / "out/h_asd.txt"), HasSubstr("# AT MOST: in "));
  EXPECT_THAT(csv, HasSubstr(",upper\n"));
  EXPECT_THAT(straytrace({"noise", folder / "out/run.h5", "--format", "json"}).out, HasSubstr("\"at_most\": true"));
  Finished const control = straytrace({"run", source_folder + "/examples/et_hf_arm.yaml", "-o", folder / "arm.h5", "-p",
                                       "first_baffle=4000m", "--histories", "2e5", "--quiet"});
  EXPECT_THAT(control.out, HasSubstr("±"));
  EXPECT_THAT(control.out, Not(HasSubstr("h = at most")));
  // A run file projects them without tracing or building anything again.
  EXPECT_THAT(straytrace({"noise", folder / "out/run.h5"}).out, HasSubstr("baffles_end·E"));
  std::string const reader = "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='" + source_folder +
                             "/python' timeout 60 /usr/bin/python3 -c \"import straytrace; r = straytrace.open('" +
                             (folder / "out/run.h5") +
                             "').routes; k = r.kind.index('edge'); assert r.sigma[k] == 0 and 'bound' in r.statement[k]"
                             " and 'scattered' in r.kind\"";
  EXPECT_EQ(std::system(reader.c_str()), 0);
}

// Numbers of the chain of factors are bounds where those of the row are, and only sampled ones have a Monte-Carlo
// error. Control: a scattered route.
TEST(EdgesCommand, TheChainOfABoundIsABound) {
  Folder const folder;
  ASSERT_EQ(straytrace({"run", et_edges, "-o", folder / "out", "--histories", "16384", "--quiet"}).code, 0);
  auto const table = answer({"paths", folder / "out/run.h5"});
  std::set<std::string> kinds;
  for (auto const& row : table["routes"]) {
    std::string const kind = row["kind"];
    if (!row["resolved"].get<bool>() || !kinds.insert(kind).second) continue;
    Words const words{"explain", "h", folder / "out/run.h5", "--path", row["rank"].dump(), "--at", "10"};
    std::string const text = straytrace(words).out;
    auto const factors = answer(words)["factors"];
    bool const edge = kind == "edge";
    EXPECT_EQ(factors["h"].contains("at_most"), edge);
    EXPECT_EQ(factors["C"].contains("at_most"), edge);
    EXPECT_FALSE(factors["C_rev"].contains("at_most"));
    if (edge) {
      EXPECT_THAT(text, HasSubstr("  h at most "));
      EXPECT_THAT(text, HasSubstr("  C           at most "));
      EXPECT_THAT(text, Not(HasSubstr("Monte-Carlo error")));
    } else {
      EXPECT_THAT(text,
                  ::testing::AllOf(HasSubstr("  h = "), HasSubstr(" ± "), HasSubstr("/sqrt(Hz), Monte-Carlo error;")));
      EXPECT_THAT(text, Not(HasSubstr("at most")));
    }
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"edge", "scattered"}));
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
  for (char const* distance : {"500", "-1 m", "3 s", "0 m"}) {
    Finished const rejected = straytrace({"apertures", virgo_arm, "--profile", "ETM", "--distance", distance});
    EXPECT_EQ(rejected.code, 2) << distance;
    EXPECT_THAT(rejected.err, HasSubstr("write for example --distance"));
  }
  EXPECT_EQ(straytrace({"apertures", virgo_arm, "--profile", "ETM"}).code, 2);
}

// Mounts, tilted mirrors and all behind them are listed; impossible input is an error with a reason.
TEST(AperturesCommand, WholePathAndErrors) {
  std::string const bench = source_folder + "/examples/bench.yaml";
  Finished const table = straytrace({"apertures", bench, "--show", "40"});
  ASSERT_EQ(table.code, 0) << table.err;
  for (char const* rim :
       {"mount_1/front", "mount_2/back", "lens_2/back", "fold/front", "pick_off/front", "photodiode/sensor"})
    EXPECT_THAT(table.out, HasSubstr(rim));
  auto const rejected = [&](Words const& words, char const* reason) {
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 2);
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr(reason));
  };
  rejected({"apertures", bench, "--show", "0"}, "is not a whole number from 1 to 1000000");
  rejected({"apertures", virgo_arm, "--profile", "ETM", "--distance", "1 um"}, "nearer than the beam is wide");
  rejected({"apertures", bench, "--profile", "fold/front", "--distance", "1 m"},
           "no round edge about the chief ray, across a round beam");
}

// A lens that is too small for the main beam, by name and share, for every command; control: one that is large enough.
TEST(AperturesCommand, LossesOfTheMainBeamAreWarnedOf) {
  Folder const folder;
  std::string const text = text_of(source_folder + "/examples/bench.yaml");
  write_text(folder / "wide.yaml", edited(text, "waist: 3 mm", "waist: 22 mm"));
  for (char const* command : {"check", "apertures"}) {
    std::string const said = straytrace({command, folder / "wide.yaml"}).err;
    EXPECT_THAT(said, HasSubstr("beam 'input' loses 7."));
    EXPECT_THAT(said, HasSubstr("% on 'mount_1/front'"));
  }
  EXPECT_THAT(straytrace({"check", source_folder + "/examples/bench.yaml"}).err, ::testing::Not(HasSubstr("loses")));
}

}  // namespace
}  // namespace straytrace::testing
