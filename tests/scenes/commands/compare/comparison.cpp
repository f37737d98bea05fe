// SPDX-License-Identifier: BSD-3-Clause
// Runs side by side: errors of changes and ratios from paired replicas (docs/theory/errors.md, Comparison of runs), and
// the page of `report A.h5 B.h5`.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "base/every_module.hpp"
#include "scenes/answers.hpp"
#include "session/compare/run_diff.hpp"

namespace straytrace::testing::app_comparison {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double h_of_route = 1e-22;  // 1/sqrt(Hz), on a bin of 1 Hz

// A run with one route whose light in replica r is light(r), in units of its expectation.
RunFile run_of(std::uint64_t seed, std::string const& model, std::function<double(std::size_t)> const& light) {
  RunFile run;
  run.about.model_hash = model;
  CouplingTable& table = run.trace.coupling;
  table.seed = seed;
  table.histories = 32 * 1000;
  table.replica_histories.fill(1000);
  table.groups = {"ITM", "wall"};
  table.ports = {"ITM"};
  CouplingClass c;
  c.hash = 7;
  c.port = {0};
  c.steps = {{{0}, Event::scatter}, {{1}, Event::scatter}, {{0}, Event::scatter}};
  double sum = 0, square = 0;
  for (std::size_t r = 0; r < c.replica_sum.size(); ++r) sum += c.replica_sum[r] = light(r);
  for (double const s : c.replica_sum) square += std::pow(s / sum - 1.0 / 32, 2);
  NoiseTrace t;
  t.name = route_name(table, c);
  t.hash = c.hash;
  t.asd = {h_of_route * std::sqrt(sum / 32)};
  t.sigma = {t.asd[0] / 2 * std::sqrt(square * 32 / 31)};  // h goes with the root of the power
  table.classes.push_back(c);
  run.noise.emplace();
  run.noise->grid.edges = {10, 11};
  run.noise->total = t;
  run.noise->routes.push_back(t);
  return run;
}

// Of a = 1 + s x and b = 1 + s (c x + sqrt(1 - c^2) y) in each of 32 replicas, with normal x and y, the root of the
// ratio of the means has the standard deviation s/2 sqrt(2 (1 - c)/32): the errors that the runs state and the spread
// of 400 pairs must both agree. Control: independent errors are larger by 1/sqrt(1 - c) = 3.2.
TEST(Comparison, PairedErrorsAreTheSpreadOfPairs) {
  constexpr double s = 0.2, c = 0.9;
  constexpr int pairs = 400;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double stated = 0, independent = 0, spread = 0, of_change = 0, changes = 0;
  for (int k = 0; k < pairs; ++k) {
    std::array<double, 32> x{}, y{};
    for (std::size_t r = 0; r < 32; ++r) {
      x[r] = normal(random);
      y[r] = normal(random);
    }
    auto const a = [&](std::size_t r) { return 1 + s * x[r]; };
    auto const b = [&](std::size_t r) { return 1 + s * (c * x[r] + std::sqrt(1 - c * c) * y[r]); };
    RunFile const before = run_of(1, "a", a);
    Change const paired = run_differences(before, run_of(1, "b", b)).whole,
                 alone = run_differences(before, run_of(2, "b", b)).whole;
    ASSERT_EQ(paired.ratio().value, alone.ratio().value);
    EXPECT_FALSE(alone.error.paired);
    EXPECT_TRUE(paired.error.paired);
    stated += std::pow(paired.error.ratio, 2) / pairs;
    independent += std::pow(alone.error.ratio, 2) / pairs;
    spread += std::pow(std::log(paired.ratio().value), 2) / pairs;
    of_change += std::pow(paired.error.change, 2) / pairs;
    changes += std::pow(paired.after.value - paired.before.value, 2) / pairs;
  }
  double const expected = s / 2 * std::sqrt(2 * (1 - c) / 32);
  EXPECT_NEAR(std::sqrt(stated) / expected, 1, 0.05);
  EXPECT_NEAR(std::sqrt(spread) / expected, 1, 0.15);  // 4 standard errors of 400 pairs
  EXPECT_NEAR(std::sqrt(changes / of_change), 1, 0.15);
  EXPECT_NEAR(std::sqrt(independent) / expected, 1 / std::sqrt(1 - c), 0.3) << "control";
}

// Replicas that agree to rounding say nothing of a difference that no history has shown: it may be as large as one
// history, here 2 % of the power and 1 % of h. Controls: histories that are all small; other seeds.
TEST(Comparison, WhatNoHistoryShowsIsInTheError) {
  auto const light = [](std::size_t r) { return 1 + 0.1 * std::sin(double(r)); };
  auto const error = [&](std::uint64_t seed, double largest) {
    RunFile before = run_of(1, "a", light), after = run_of(seed, "b", light);
    for (RunFile* run : {&before, &after}) run->trace.coupling.classes[0].coupling.largest_share = largest;
    return run_differences(before, after).whole.error.ratio;
  };
  EXPECT_NEAR(error(1, 0.02), 0.01, 1e-9);
  EXPECT_LT(error(1, 1e-6), 1e-6) << "control";
  EXPECT_NEAR(error(2, 0.02), error(2, 1e-6), 1e-12) << "control";
}

// Three quarters of the light everywhere is a ratio of sqrt(3/4), without an error of the light. Control: other seeds.
TEST(Comparison, TheSameLightTimesAFactorHasNoError) {
  auto const light = [](std::size_t r) { return 1 + 0.1 * std::sin(double(r)); };
  auto const less = [&](std::size_t r) { return 0.75 * light(r); };
  Change const c = run_differences(run_of(1, "a", light), run_of(1, "b", less)).whole;
  EXPECT_NEAR(c.ratio().value, std::sqrt(0.75), 1e-12);
  EXPECT_LT(c.error.ratio, 1e-9);
  EXPECT_LT(c.ratio().sigma, 1e-3) << "what is left are shared spectra";
  EXPECT_GT(c.sigmas(), -1e3);
  EXPECT_EQ(outcome_text(c), "fell");
  EXPECT_GT(run_differences(run_of(1, "a", light), run_of(2, "b", less)).whole.error.ratio, 5e-3) << "control";
}

std::string const arm = R"(straytrace: 1
params: {opening: 20 cm, place: 100 m}
materials: {hr: {scatter: {model: lambertian, tis: 5 ppm}}, wall: {scatter: {model: lambertian, brdf: 1e-2 /sr}}}
bodies:
  mirrors: {motion: still}
  baffle: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: -1, from: 1 Hz, to: 1 kHz}}, others: still}}
scene:
  - {name: ITM, use: mirror, facing: [0, 0, 1], radius_of_curvature: 1420 m, body: mirrors, material: hr}
  - {name: ETM, use: mirror, at: [0 m, 0 m, 3 km], facing: [0, 0, -1], radius_of_curvature: 1683 m, body: mirrors, material: hr}
  - {name: baffle, shape: {disk: {inner_radius: opening, outer_radius: 50 cm}}, at: [0 m, 0 m, place], facing: [0, 0, -1], side: front, body: baffle, material: wall}
beams: {arm: {cavity: [ITM, ETM], power: 1 kW}}
ports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}
receivers: {end: {on: ETM}}
interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, arm_power: 1 kW}
noise: {band: [10 Hz, 100 Hz], points_per_decade: 10}
trace: {histories: 16384}
)";

void run(Folder const& folder, std::string const& scene, std::string const& name, Words const& more = {}) {
  write_text(folder / (name + ".yaml"), scene);
  Words words{"run", folder / (name + ".yaml"), "-o", folder / (name + ".h5"), "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  Finished const f = straytrace(words);
  ASSERT_EQ(f.code, 0) << f.err;
}

// A baffle at 104 m instead of 100 m, with 10 seeds: the error from paired replicas is the spread of the ratio over the
// seeds. Control: independent errors are larger.
TEST(Comparison, PairedErrorsAreTheSpreadOverSeeds) {
  Folder const folder;
  constexpr int seeds = 10;
  std::vector<double> ratios;
  double stated = 0, independent = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    run(folder, arm, "near", {"--seed", std::to_string(seed), "--histories", "65536"});
    run(folder, arm, "far", {"--seed", std::to_string(seed), "--histories", "65536", "-p", "place=102m"});
    auto const d = run_differences(read_run(folder / "near.h5"), read_run(folder / "far.h5"));
    EXPECT_TRUE(d.whole.error.paired);
    ratios.push_back(std::log(d.whole.ratio().value));
    stated += std::pow(d.whole.error.ratio, 2) / seeds;
    independent += (std::pow(d.whole.before.sigma / d.whole.before.value, 2) +
                    std::pow(d.whole.after.sigma / d.whole.after.value, 2)) /
                   seeds;
    fs::remove(folder / "near.h5");
    fs::remove(folder / "far.h5");
  }
  double const mean = std::accumulate(ratios.begin(), ratios.end(), 0.0) / seeds;
  double variance = 0;
  for (double const x : ratios) variance += (x - mean) * (x - mean) / (seeds - 1);
  RecordProperty("spread", fmt::format("{:.3g}", std::sqrt(variance)));
  RecordProperty("stated", fmt::format("{:.3g}", std::sqrt(stated)));
  RecordProperty("independent", fmt::format("{:.3g}", std::sqrt(independent)));
  EXPECT_GT(std::sqrt(variance / stated), 0.2);   // stated is at least one history; chi^2 of 9 degrees: 0.44 at 1e-3
  EXPECT_LT(std::sqrt(variance / stated), 1.65);  // 1e-3
  EXPECT_GT(std::sqrt(independent / stated), 2.5) << "control";
}

// The page and `diff` have the same numbers. Control: those of another pair.
TEST(Comparison, ThePageHasTheNumbersOfDiff) {
  Folder const folder;
  run(folder, arm, "a");
  run(folder, arm, "b", {"-p", "opening=15cm"});
  run(folder, edited(arm, "1e-2 /sr", "3e-2 /sr"), "c", {"--seed", "2"});
  Finished const f = straytrace({"report", folder / "a.h5", folder / "b.h5", folder / "c.h5", "--quiet"});
  ASSERT_EQ(f.code, 0) << f.err;
  std::string const page = text_of(folder / "comparison.html");
  std::string const begin = "id=\"data\">";
  std::size_t const from = page.find(begin) + begin.size();
  auto const j = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  ASSERT_EQ(j["runs"].size(), 3u);
  ASSERT_EQ(j["pairs"].size(), 2u);
  std::vector<std::string> found;
  for (std::size_t i : {0, 1}) {
    auto const d = answer({"diff", folder / "a.h5", folder / (i == 0 ? "b.h5" : "c.h5")})["results"];
    auto const& pair = j["pairs"][i];
    EXPECT_EQ(d["whole"]["error"], i == 0 ? "paired replicas" : "independent");
    EXPECT_EQ(pair["routes"]["rows"].size() + pair["still"].get<std::size_t>(), d["routes"].size());
    for (std::size_t r = 0; r < pair["routes"]["rows"].size(); ++r) {  // still ones are last
      auto const &row = pair["routes"]["rows"][r], &of = d["routes"][r];
      EXPECT_EQ(row[0], of["what"]);
      if (of["ratio"].is_object() && of["ratio"]["sigma"] > 0) {
        EXPECT_EQ(row[1], with_brackets(of["ratio"]["value"], of["ratio"]["sigma"]));
      }
    }
    ASSERT_EQ(pair["receivers"]["rows"].size(), 1u);
    EXPECT_EQ(pair["receivers"]["rows"][0][0], "end");
    found.push_back(pair["sentence"]);
  }
  EXPECT_NE(found[0], found[1]) << "control";
  EXPECT_THAT(found[0], HasSubstr("paired replicas"));
  // diff of all three: each with the first.
  std::string const a = folder / "a.h5", b = folder / "b.h5", c = folder / "c.h5";
  auto const all = answer({"diff", a, b, c});
  EXPECT_EQ(all["reference"], a);
  ASSERT_EQ(all["comparisons"].size(), 2u);
  EXPECT_EQ(all["comparisons"][0]["results"], answer({"diff", a, b})["results"]);
  EXPECT_EQ(all["comparisons"][1]["results"], answer({"diff", a, c})["results"]);
  EXPECT_NE(all["comparisons"][1]["results"], answer({"diff", b, c})["results"]) << "control";
  std::string const text = straytrace({"diff", a, b, c}).out;
  EXPECT_THAT(text, HasSubstr(b + " against " + a + "\n" + straytrace({"diff", a, b}).out));
  EXPECT_THAT(text, HasSubstr(c + " against " + a + "\n"));
  EXPECT_THAT(j["pairs"][0]["models"].dump(), HasSubstr("20 cm -> 15 cm"));
  EXPECT_THAT(j["pairs"][1]["models"].dump(), HasSubstr("0.03"));
  EXPECT_THAT(page, Not(HasSubstr(folder.path())));
}

// Runs on other grids are compared where both have noise: three times the points per decade are no change. Control:
// twice the BRDF.
TEST(Comparison, OtherGridsAreCompared) {
  Folder const folder;
  run(folder, arm, "a");
  std::string const fine =
      edited(arm, "[10 Hz, 100 Hz], points_per_decade: 10", "[20 Hz, 200 Hz], points_per_decade: 30");
  run(folder, fine, "b");
  run(folder, edited(fine, "1e-2 /sr", "2e-2 /sr"), "c");
  RunFile const a = read_run(folder / "a.h5"), b = read_run(folder / "b.h5"), c = read_run(folder / "c.h5");
  RunDifference const d = run_differences(a, b);
  EXPECT_EQ(d.low, 20);
  EXPECT_EQ(d.high, 100);
  EXPECT_NEAR(d.whole.ratio().value, 1, 0.02);
  EXPECT_GT(run_differences(a, c).whole.ratio().value, 1.3) << "control";
  std::vector<Change> const bins = changes_by_frequency(a, b);
  ASSERT_EQ(bins.size(), a.noise->grid.size());
  EXPECT_EQ(bins.front().before.value, 0) << "below the common band";
  EXPECT_NEAR(bins.back().ratio().value, 1, 0.02);
}

// All problems at once, and nothing is written. Control: two sound runs.
TEST(Comparison, WrongInputsAreReportedTogether) {
  Folder const folder;
  run(folder, arm, "a");
  run(folder, edited(arm, "[10 Hz, 100 Hz]", "[1 kHz, 2 kHz]"), "high");
  ASSERT_EQ(straytrace({"trace", folder / "a.yaml", "-o", folder / "dark.h5", "--quiet"}).code, 0);
  std::string damaged = text_of(folder / "a.h5");
  damaged.resize(damaged.size() / 2);
  write_text(folder / "damaged.h5", damaged);
  std::string const told =
      error_text({"report", folder / "a.h5", folder / "dark.h5", folder / "damaged.h5", folder / "high.h5",
                  folder / "a.yaml", folder / "none.h5", "-o", folder / "x.html"});
  EXPECT_THAT(told, HasSubstr("has no noise to compare"));
  EXPECT_THAT(told, HasSubstr("damaged.h5"));
  EXPECT_THAT(told, HasSubstr("does not overlap that of the first run, 10 to 100 Hz"));
  EXPECT_THAT(told, HasSubstr("is a scene, not a run"));
  EXPECT_THAT(told, HasSubstr("none.h5"));
  std::string const of_one = error_text({"report", folder / "a.h5", folder / "a.h5", "--show", "3", "--csv", "x"});
  EXPECT_THAT(of_one, HasSubstr("does not have --show, --csv"));
  EXPECT_THAT(error_text({"report", folder / "a.h5", folder / "a.h5", "-o", folder / "x.pdf"}), HasSubstr(".html"));
  EXPECT_FALSE(fs::exists(folder / "x.html"));
  EXPECT_FALSE(fs::exists(folder / "comparison.html"));
  EXPECT_EQ(straytrace({"report", folder / "a.h5", folder / "a.h5", "-o", folder / "x.html"}).code, 0) << "control";
  EXPECT_THAT(text_of(folder / "x.html"), HasSubstr("are the same"));
}

TEST(Comparison, LabelsAreShortAndDistinct) {
  EXPECT_EQ(run_labels({"/x/before/run.h5", "after/run.h5"}), (std::vector<std::string>{"before", "after"}));
  EXPECT_EQ(run_labels({"a.h5", "b/a.h5"}), (std::vector<std::string>{"a (1)", "a (2)"}));
}

}  // namespace
}  // namespace straytrace::testing::app_comparison
