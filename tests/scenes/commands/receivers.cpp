// SPDX-License-Identifier: BSD-3-Clause
// Receivers as a user meets them: trace, paths, census, maps, stop rules, messages (R2.24,
// R3.28-R3.32).
#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing::app_receivers {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string const two_mirrors = source_folder + "/examples/two_mirrors.yaml";

Finished trace_two(Folder const& folder, Words const& more) {
  Words words{"trace", two_mirrors, "-o", folder / "run.h5"};
  words.insert(words.end(), more.begin(), more.end());
  return straytrace(words);
}

TEST(ReceiversCommand, TraceNeedsNoInterferometer) {
  Folder const folder;
  Finished const checked = straytrace({"check", two_mirrors, "--strict"});
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("2 receivers"));
  Finished const traced = trace_two(folder, {"--histories", "2e5"});
  ASSERT_EQ(traced.code, 0) << traced.err;
  EXPECT_THAT(traced.out, HasSubstr("probe·B > M1·R > M2·R > det·D"));
  EXPECT_THAT(traced.out, HasSubstr("power/W"));
  EXPECT_THAT(traced.out, HasSubstr("upper right"));
  Finished const by = straytrace({"paths", folder / "run.h5", "--by", "receiver"});
  EXPECT_EQ(by.code, 0) << by.err;
  EXPECT_THAT(traced.out, ::testing::StartsWith(by.out));  // then where the light went
  EXPECT_EQ(straytrace({"paths", folder / "run.h5"}).out, by.out);
  Finished const census = straytrace({"paths", folder / "run.h5", "--census"});
  EXPECT_THAT(census.out, HasSubstr("M2"));
  EXPECT_THAT(straytrace({"paths", folder / "run.h5", "--census", "--csv"}).out, HasSubstr("PD,M1,"));
  EXPECT_THAT(straytrace({"paths", folder / "run.h5", "--by", "receiver", "--csv"}).out, HasSubstr("PD,0,,all,"));
  EXPECT_THAT(straytrace({"paths", folder / "run.h5", "--format", "json"}).out, HasSubstr("\"beam_power_W\": 2.0"));
  Finished const noise = straytrace({"noise", folder / "run.h5"});
  EXPECT_EQ(noise.code, 2);
  EXPECT_THAT(noise.err, HasSubstr("without an interferometer"));
}

// The warning before the trace and the status after it agree on too few histories; control: twice as many.
TEST(ReceiversCommand, TooFewHistoriesGiveNoError) {
  for (auto const& [histories, few] : {std::pair{"200", true}, {"500", false}}) {
    Folder const folder;
    Finished const run = straytrace({"run", two_mirrors, "-o", folder / "out", "--histories", histories});
    auto const says = [](std::string const& text, char const* words) { return text.find(words) != text.npos; };
    EXPECT_EQ(says(run.err, "are too few for an error"), few) << run.err;
    EXPECT_EQ(says(text_of(folder / "out/receivers.csv"), ",resolved,"), !few);
    std::string const report = text_of(folder / "out/report.txt");
    EXPECT_EQ(says(report.substr(report.find("Where the light went")), "about "), few) << report;
    Finished const paths = straytrace({"paths", folder / "out/run.h5", "--format", "json"});
    EXPECT_EQ(says(paths.out, "\"share\": 1.0"), false) << paths.out;  // of what is not resolved, nothing is known
  }
}

TEST(ReceiversCommand, RunReportsTheEnergyBalance) {
  Folder const folder;
  Finished const run = straytrace({"run", two_mirrors, "-o", folder / "out", "--histories", "2e5"});
  ASSERT_EQ(run.code, 0) << run.err;
  std::string const report = text_of(folder / "out/report.txt");
  for (char const* words : {"Receivers", "absorbed", "escaped", "(rounding)", "power/W", "Light on objects", "PD"})
    EXPECT_THAT(report, HasSubstr(words));
  EXPECT_THAT(text_of(folder / "out/receivers.csv"), HasSubstr("# main mode: 2 W"));
  EXPECT_FALSE(fs::exists(folder / "out/h_asd.txt"));
}

// Without stated pixels: cells of the round detector, from the run file alone. Irradiance times area is the power of
// the receiver (control: with the areas of squares of the same sides).
TEST(ReceiversCommand, MapsOfCellsHoldThePower) {
  Folder const folder;
  std::string const scene = folder / "cells.yaml";
  write_text(scene, edited(text_of(two_mirrors), "map: {pixels: [48, 48], width: 4 cm}", "map: {}"));
  Finished const run = straytrace({"run", scene, "-o", folder / "out", "--histories", "2e5", "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(text_of(folder / "out/report.html"), HasSubstr("\"chart\":\"polar\""));
  Launch how;
  how.picture = true;
  Finished const maps = Program({"maps", folder / "out/run.h5", "-o", folder / "maps"}, how).wait();
  ASSERT_EQ(maps.code, 0) << maps.err;
  if (maps.err.empty()) {
    EXPECT_GT(fs::file_size(folder / "maps/PD.png"), 10000u);
  }
  std::istringstream lines(text_of(folder / "maps/PD_image.csv"));
  double power = 0, flat = 0;
  int cells = 0;
  for (std::string line; std::getline(lines, line);) {
    double low = 0, high = 0, first = 0, last = 0, area = 0, irradiance = 0;
    int number = 0;
    if (std::sscanf(line.c_str(), "%d,%lf,%lf,%lf,%lf,%lf,%lf", &number, &low, &high, &first, &last, &area,
                    &irradiance) != 7)
      continue;
    EXPECT_EQ(number, cells++);
    if (!std::isfinite(irradiance)) continue;
    power += area * irradiance;
    flat += (high - low) * (last - first) * irradiance;
  }
  EXPECT_GT(cells, 100);
  double const received = 2 * read_run(folder / "out/run.h5").trace.coupling.received_power.at(0).mean;  // of 2 W
  EXPECT_NEAR(power / received, 1, 1e-9);
  EXPECT_GT(std::fabs(flat / received - 1), 0.5);
}

TEST(ReceiversCommand, Maps) {
  Folder const folder;
  ASSERT_EQ(trace_two(folder, {"--histories", "2e5"}).code, 0);
  Launch how;
  how.picture = true;
  Finished const maps = straytrace({"maps", folder / "run.h5", "-o", folder / "maps/"}, how);
  EXPECT_EQ(maps.code, 0) << maps.err;
  EXPECT_THAT(maps.out, HasSubstr("PD_image.csv"));
  for (char const* file : {"PD_image.npy", "PD_image_sigma.npy", "PD_field.npy", "PD_angles.csv", "PD_quadrants.csv"})
    EXPECT_TRUE(fs::exists(folder / (std::string("maps/") + file))) << file;
  if (maps.err.empty()) {
    EXPECT_TRUE(fs::exists(folder / "maps/PD.png") && fs::exists(folder / "maps/plane.png"));
  }
  ASSERT_EQ(straytrace({"trace", virgo_arm, "-o", folder / "arm.h5", "--histories", "4096"}).code, 0);
  Finished const none = straytrace({"maps", folder / "arm.h5", "-o", folder / "no"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("has no receivers"));
}

TEST(ReceiversCommand, StopRules) {
  Folder const folder;
  Finished const reached = trace_two(folder, {"--until", "receiver:PD < 5 %, class:probe > M1 > M2 > det < 5 %"});
  EXPECT_EQ(reached.code, 0) << reached.err;
  EXPECT_EQ(read_run(folder / "run.h5").trace.total.histories, 2880u);  // the second look: 45 blocks of 64
  auto const rejected = [&](std::string const& rule, std::string const& words) {
    Finished const r = straytrace({"trace", two_mirrors, "-o", folder / "no.h5", "--until", rule});
    EXPECT_EQ(r.code, 2) << rule;
    EXPECT_THAT(r.err, HasSubstr(words));
    EXPECT_FALSE(fs::exists(folder / "no.h5"));
  };
  // `histories` of the scene stays the upper limit; control: a scene without.
  write_text(folder / "short.yaml", edited(text_of(two_mirrors), "trace: {", "trace: {histories: 200000, "));
  Finished const capped =
      straytrace({"trace", folder / "short.yaml", "-o", folder / "short.h5", "--until", "receiver:PD < 0.01 %"});
  EXPECT_EQ(capped.code, 0) << capped.err;
  EXPECT_EQ(read_run(folder / "short.h5").trace.total.blocks, 49u);
  EXPECT_THAT(straytrace({"trace", "--help"}).out, HasSubstr("'histories' of the scene stays the"));
  rejected("receiver:PB < 5 %", "did you mean 'PD'?");
  rejected("class:probe > M3 < 5 %", "did you mean 'M1'?");
  rejected("h_total < 5 %", "without an interferometer");
  rejected("receivers < 5 %", "receiver:*");
  // In the scene the message has a place.
  write_text(folder / "wrong.yaml", edited(text_of(two_mirrors), "receiver:*", "receiver:PB"));
  Finished const located = straytrace({"check", folder / "wrong.yaml"});
  EXPECT_EQ(located.code, 2);
  EXPECT_THAT(located.err, ::testing::ContainsRegex("wrong.yaml:[0-9]+:[0-9]+: error: 'PB' is not a receiver"));
  EXPECT_THAT(located.err, HasSubstr("did you mean 'PD'?"));
}

TEST(ReceiversCommand, InterruptedRunsResumeWithTheSameBits) {
  Folder const folder;
  auto const trace = [&](std::string const& file, Words const& more) {
    Words words{"trace", two_mirrors, "-o", folder / file, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return straytrace(words).code;
  };
  EXPECT_EQ(trace("a.h5", {"--until", "receiver:PD < 1e-9", "--max-time", "0.3s"}), 85);
  std::string const n = std::to_string(read_run(folder / "a.h5").trace.total.histories + 10 * largest_block);
  EXPECT_EQ(trace("a.h5", {"--histories", n}), 0);
  EXPECT_EQ(trace("b.h5", {"--histories", n, "--threads", "1"}), 0);
  EXPECT_EQ(trace("c.h5", {"--histories", n, "--threads", "3"}), 0);
  EXPECT_EQ(data_hash(folder / "a.h5"), data_hash(folder / "b.h5"));
  EXPECT_EQ(data_hash(folder / "a.h5"), data_hash(folder / "c.h5"));
  EXPECT_EQ(trace("d.h5", {"--histories", n, "--seed", "2"}), 0);
  EXPECT_NE(data_hash(folder / "a.h5"), data_hash(folder / "d.h5"));
}

}  // namespace
}  // namespace straytrace::testing::app_receivers
