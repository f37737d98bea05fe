// SPDX-License-Identifier: BSD-3-Clause
// Numbers with errors, path table, exports and report.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sstream>

#include "results/curves/band.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/text/columns.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportValues, DigitsFollowTheError) {
  EXPECT_EQ(with_error(1.2345e-24, 0.04e-24), "1.23e-24 ± 0.04e-24");
  EXPECT_EQ(with_error(6.1234, 0.21), "6.1 ± 0.2");
  EXPECT_EQ(with_error(6.1234, 0.012), "6.123 ± 0.012");
  EXPECT_EQ(with_error(9.9996e-24, 0.04e-24), "1.000e-23 ± 0.004e-23");
  EXPECT_EQ(with_error(0.4e-24, 1.24e-24), "0.4e-24 ± 1.2e-24");
  EXPECT_EQ(with_error(-1.5e-24, 0.3e-24), "-1.5e-24 ± 0.3e-24");
  EXPECT_EQ(with_error(12345, 321), "12300 ± 300");
  EXPECT_EQ(with_error(0, 0.002), "0.000 ± 0.002");
  EXPECT_EQ(with_error(20146.9, 0), "2.01e+04 (computed)");
  EXPECT_EQ(with_error(0.61, 3e-17) + ", " + with_error(2.1216e-18, 7e-35), "0.61 ± 3e-17, 2.122e-18 ± 7e-35");
  EXPECT_EQ(with_brackets(1.23456e-24, 0) + ", " + with_brackets(4.990008e-6, 4e-22),
            "1.23e-24 computed, 4.99e-06(<1)");
  EXPECT_EQ(with_brackets(1.2345e-24, 0.04e-24), "1.23(4)e-24");
  EXPECT_EQ(with_brackets(6.1234, 0.012), "6.123(12)");
  EXPECT_EQ(with_brackets(0.4e-24, 1.24e-24), "0.4(1.2)e-24");
  EXPECT_EQ(with_brackets(12345, 321), "12300(300)");
}

TEST(ReportValues, WhatIsNotANumberIsUnresolved) {
  EXPECT_EQ(with_error(not_a_number, 1), "unresolved");
  EXPECT_EQ(with_error(1, infinity), "unresolved");
  EXPECT_EQ(with_brackets(infinity, 1), "unresolved");
}

// Rounding costs at most half of the last digit, that is 26 % of the error; a control with one digit less costs more.
TEST(ReportValues, PrintedValuesStayWithinTheError) {
  auto worst = [](double coarser) {
    double largest = 0;
    for (int i = 1; i < 400; ++i) {
      double const value = 1e-20 * spread(std::size_t(i)),
                   sigma = value * std::pow(10.0, -4 * spread(std::size_t(3 * i)));
      double const printed = std::stod(with_error(value, sigma * coarser));
      largest = std::max(largest, std::fabs(printed - value) / sigma);
    }
    return largest;
  };
  EXPECT_LT(worst(1), 0.26);
  EXPECT_GT(worst(10), 0.26);
}

class ReportTables : public ::testing::Test {
 protected:
  PathTable table(TableSettings const& settings = {{10, 30, 100, 5000}, 10, 500, 12}) {
    return path_table(trace.coupling, &noise, &shake, settings);
  }
  TraceResult trace = trace_result();
  NoiseBudget noise = noise_budget(trace.coupling);
  MotionSet shake = motion();
};

TEST_F(ReportTables, SharesAddUpToOneOverResolvedRoutes) {
  double sum = 0;
  for (PathRow const& row : table().rows)
    if (row.resolved) sum += row.share.value;
  EXPECT_NEAR(sum, 1, 1e-12);
}

// Without the rule that unresolved routes do not count, the sum is not one.
TEST_F(ReportTables, SharesWithAnUnresolvedRouteWouldNot) {
  PathTable const t = table();
  double total = 0, all = 0;
  for (std::size_t i = 0; i < noise.routes.size(); ++i) {
    double const p = band_power(noise.routes[i], noise.grid, 10, 500).value;
    all += p;
    if (noise.routes[i].resolved) total += p;
  }
  EXPECT_GT(std::fabs(all / total - 1), 1e-3);
  EXPECT_NEAR(t.rows[0].share.value, band_power(noise.routes[0], noise.grid, 10, 500).value / total, 1e-12);
}

TEST_F(ReportTables, RanksByShareAndUnresolvedLast) {
  PathTable const t = table();
  ASSERT_EQ(t.rows.size(), route_count);
  for (std::size_t i = 0; i + 2 < t.rows.size(); ++i) EXPECT_GE(t.rows[i].share.value, t.rows[i + 1].share.value);
  EXPECT_FALSE(t.rows.back().resolved);
  EXPECT_EQ(t.unresolved, 1u);
  EXPECT_TRUE(std::isnan(t.rows.back().strain[0].value));
  EXPECT_TRUE(std::isnan(t.rows[0].strain[3].value));  // 5 kHz: outside the grid
}

TEST_F(ReportTables, RanksByCouplingWithoutNoise) {
  PathTable const t = path_table(trace.coupling, nullptr, nullptr, {});
  EXPECT_FALSE(t.has_noise);
  for (std::size_t i = 0; i + 2 < t.rows.size(); ++i)
    EXPECT_GE(t.rows[i].coupling.mean * t.rows[i].reverse, t.rows[i + 1].coupling.mean * t.rows[i + 1].reverse);
  EXPECT_THAT(path_text(t, 12), Not(HasSubstr("share")));
}

// The tube shakes a thousand times more than the mirror; the control swaps them.
TEST_F(ReportTables, NamesTheBodyThatShakesThePhase) {
  EXPECT_EQ(table().rows[0].body, "tube");
  EXPECT_NEAR(table().rows[0].phase_sensitivity, 1.18e7, 0.01e7);
  std::swap(shake.inputs[0].spectrum, shake.inputs[1].spectrum);
  EXPECT_EQ(table().rows[0].body, "ITM");
}

TEST_F(ReportTables, TextStatesUnresolvedAndSums) {
  std::string const text = path_text(table(), 3);
  EXPECT_THAT(text, HasSubstr("3 further routes"));
  EXPECT_THAT(text, HasSubstr("total (lower bound)"));
  EXPECT_THAT(text, HasSubstr("unresolved: " + noise.routes[4].name + ": one history carries 31 % of the sum"));
  EXPECT_THAT(text, HasSubstr("1 unresolved route, observed part"));
  EXPECT_THAT(text, HasSubstr("wrapped"));
  EXPECT_THAT(text, HasSubstr("linear > "));
  noise.routes[4].resolved = trace.coupling.classes[4].coupling.trusted = true;
  EXPECT_THAT(path_text(table(), 3), Not(HasSubstr("unresolved")));
}

// The coupling of light at small angles has an error over random mirrors, and h half of it, relative. The trace's own
// error stays without it: no history lowers it. Control: the same route, where it is computed without an error.
TEST_F(ReportTables, ErrorOverMirrorsIsThatOfH) {
  CouplingClass& c = trace.coupling.classes[1];
  c.kind = ClassKind::halo;
  c.coupling.std_error = 0.2 * c.coupling.mean;
  NoiseTrace& h = noise.routes[1];
  std::fill(h.sigma.begin(), h.sigma.end(), 0);
  auto const row = [&](PathTable const& t) { return *std::ranges::find(t.rows, c.hash, &PathRow::hash); };
  PathRow const with = row(table());
  EXPECT_NEAR(with.strain[0].sigma / with.strain[0].value, 0.1, 1e-12);
  EXPECT_NEAR(with.power.sigma / with.power.value, 0.2, 1e-12);
  EXPECT_GT(with.share.sigma / with.share.value, 0.1);
  EXPECT_THAT(path_text(table(), 9), AllOf(HasSubstr("mean over random mirrors"), Not(HasSubstr("computed  "))));
  c.kind = ClassKind::speckle;
  EXPECT_EQ(row(table()).strain[0].sigma, 0);
  EXPECT_THAT(path_text(table(), 9), AllOf(Not(HasSubstr("random mirrors")), HasSubstr("computed  ")));
}

// Whole steps around "…". Names that would look the same differ; controls: short names, and one name twice.
TEST(RouteNames, LongOnesKeepTheirEndsAndStayDifferent) {
  std::string const inside = "A·T > B·T > C·T > A·T > ", a = inside + "B·R > " + inside + "C·R",
                    b = inside + "C·R > " + inside + "C·R";
  std::vector<std::string> const names{a, b, "A·T > B·T", a, "other > ITM"}, short_names = shortened_routes(names, 24);
  EXPECT_EQ(short_names[0], "A·T > B·T > … > C·R");
  EXPECT_NE(short_names[1], short_names[0]);
  for (std::string const& name : short_names) EXPECT_LE(width_of(name), 24u) << name;
  for (std::size_t i : {0u, 1u}) {
    EXPECT_TRUE(short_names[i].starts_with("A·T > ")) << short_names[i];
    EXPECT_TRUE(short_names[i].ends_with(" > C·R")) << short_names[i];
  }
  EXPECT_EQ(short_names[2], names[2]);
  EXPECT_EQ(short_names[3], short_names[0]);
  EXPECT_EQ(short_names[4], names[4]);
  EXPECT_EQ(shortened_routes(names, 1000), names);
}

TEST_F(ReportTables, TextShortensLongRoutesAndOtherFormatsDoNot) {
  std::string const note = "…: steps of a long route";
  PathTable t = table();
  EXPECT_THAT(path_text(t, 12), Not(HasSubstr(note)));
  std::string name = "ITM·S";
  for (int i = 0; i < 20; ++i) name += " > lens/front·R";
  t.rows[0].sequence = name;
  EXPECT_THAT(path_text(t, 12), AllOf(HasSubstr(note), HasSubstr("ITM·S > lens/front·R > "), Not(HasSubstr(name))));
  EXPECT_THAT(path_csv(t, content(trace, &noise)), HasSubstr(name));
  EXPECT_THAT(path_json(t, content(trace, &noise)), HasSubstr(name));
}

std::vector<std::string> split(std::string const& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (char const c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

TEST_F(ReportTables, CsvHasOneRowPerClassAndAllDigits) {
  std::istringstream lines(path_csv(table(), content(trace, &noise)));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("#")) rows.push_back(split(line));
  ASSERT_EQ(rows.size(), route_count + 1);
  for (auto const& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[0][5], "coupling");
  EXPECT_EQ(std::stod(rows[1][5]), trace.coupling.classes[0].coupling.mean);
  EXPECT_EQ(rows[1][1], "00000000000003e8");
  EXPECT_EQ(rows.back()[5], "nan");
  EXPECT_EQ(rows.back()[8], "unresolved: one history carries 31 % of the sum");
}

TEST_F(ReportTables, JsonHasNullWhereNothingIsResolved) {
  auto const j = nlohmann::json::parse(path_json(table(), content(trace, &noise)));
  EXPECT_EQ(j["routes"].size(), route_count);
  EXPECT_TRUE(j["routes"].back()["coupling"].is_null());
  EXPECT_EQ(j["routes"][0]["coupling"]["value"], trace.coupling.classes[0].coupling.mean);
  auto const s = nlohmann::json::parse(summary_json(content(trace, &noise), table()));
  EXPECT_TRUE(s["lower_bound"]);
  EXPECT_EQ(s["unresolved"].size(), 1u);
  EXPECT_EQ(s["warnings"].size(), 2u);
}

// Seventeen, and with a scanned body its lowest, highest and each of its positions.
TEST_F(ReportTables, AsdTextHasSeventeenColumnsPerFrequency) {
  std::ptrdiff_t const of_positions = noise.positions.empty() ? 0 : 2 + std::ptrdiff_t(noise.positions.size());
  std::istringstream lines(asd_text(content(trace, &noise)));
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    ++rows;
    std::istringstream words(line);
    EXPECT_EQ(std::distance(std::istream_iterator<std::string>(words), {}), 17 + of_positions);
  }
  EXPECT_EQ(rows, bin_count);
  EXPECT_THAT(asd_text(content(trace, &noise)),
              AllOf(HasSubstr("LOWER BOUND"), HasSubstr("of the resolved routes, as")));
  NoiseBudget complete = noise;  // control: with all routes in it, their linear sum is a bound
  complete.unresolved.clear();
  EXPECT_THAT(asd_text(content(trace, &complete)), HasSubstr("of all routes, as if all were in phase: upper bound"));
  noise.total.asd[0] = not_a_number;
  EXPECT_THAT(asd_text(content(trace, &noise)), HasSubstr("e+00 nan nan nan "));  // low end too: unresolved, not 0
}

// The error of the roulette is that of its known odds where few of its rare survivors were drawn; control: no odds.
TEST_F(ReportTables, RouletteHasTheErrorOfItsOdds) {
  Moments& roulette = trace.total.energy_balance[std::size_t(BalanceTerm::roulette)];
  roulette = trace.total.energy_balance[0];
  auto const line = [&] {
    std::string const text = energy_balance_text(content(trace, &noise));
    return text.substr(text.find("\nroulette"), 80);
  };
  std::string const before = line();
  trace.total.window_variance = std::pow(1e3 * double(trace.total.histories), 2);
  EXPECT_NE(line(), before);
  EXPECT_THAT(line(), HasSubstr("± 1000"));
  EXPECT_THAT(before, Not(HasSubstr("± 1000")));
}

TEST_F(ReportTables, BandsAreInReportAndSummary) {
  std::string const text = text_report(content(trace, &noise), table(), 3);
  EXPECT_THAT(text, HasSubstr("speckle 5 %"));
  EXPECT_THAT(text, HasSubstr("material steel  bracket: x 0.25 to 4 (assumed)"));
  EXPECT_THAT(text, HasSubstr("stated for: motion of tube"));
  EXPECT_THAT(summary_json(content(trace, &noise), table()), HasSubstr("\"speckle_percentiles\""));
  noise.bands = {};
  EXPECT_THAT(text_report(content(trace, &noise), table(), 3), Not(HasSubstr("speckle 5 %")));
}

// Still light 1e14 times brighter than light from the tube. Control: a route of one sequence, by power.
TEST(ReportRoutes, ARowOtherShowsTheSensitivityOfItsNoise) {
  CouplingTable t = coupling_table();
  t.classes.resize(1);
  CouplingClass& c = t.classes[0];
  PathRecord still, moving;
  still.weight = 1e-15;
  moving.weight = 1e-29;
  moving.phase_sensitivities = {{BodyId{0}, {0, 0, 1.18e7}}};
  c.records = {still, moving};
  EXPECT_NEAR(path_table(t, nullptr, nullptr, {}).rows[0].phase_sensitivity, 1.18, 1e-6);
  c.steps.clear();
  EXPECT_NEAR(path_table(t, nullptr, nullptr, {}).rows[0].phase_sensitivity, 1.18e7, 1);
}

TEST(ReportRegime, NamesTheFrequencyOfTheChange) {
  FrequencyGrid const grid{{10, 20, 40, 80, 160}};
  NoiseTrace t;
  EXPECT_EQ(regime(t, grid, 10, 160), "-");
  t.mean_square_phase = 4;
  EXPECT_EQ(regime(t, grid, 10, 160), "wrapped");  // no shares: by the rms phase
  t.linear_share = {0.1, 0.2, 0.8, 0.9};
  EXPECT_EQ(regime(t, grid, 10, 160), "linear > 40 Hz");
  EXPECT_EQ(regime(t, grid, 40, 160), "linear");
  t.linear_share = {0.9, 0.2, not_a_number, 0.1};
  EXPECT_EQ(regime(t, grid, 10, 160), "linear < 20 Hz");
  t.linear_share = {0.9, 0.2, 0.7, 0.1};
  EXPECT_EQ(regime(t, grid, 10, 160), "mixed");
}

// One bin at 4 times the line, the rest at a fifth.
NoiseBudget simple(double first) {
  NoiseBudget b;
  b.grid.edges = {10, 20, 40};
  b.design.push_back({"adv-lal", {1e-22, 1e-22}});
  b.total.name = "total";
  b.total.asd = {first * 1e-23, 0.2e-23};
  b.total.sigma = {0.1 * first * 1e-23, 0.01e-23};
  return b;
}

TEST(ReportOutcome, StaysBelowOrExceeds) {
  EXPECT_EQ(verdict_sentence(simple(0.5), 0, 0),
            "Stray light stays a factor 2.0 ± 0.2 below the margin line 0.1 x adv-lal between 10 and 40 Hz; closest at "
            "14.1 Hz. Unresolved: none.");
  EXPECT_THAT(verdict_sentence(simple(4), 0, 0), HasSubstr("exceeds the margin line 0.1 x adv-lal at 10 to 20 Hz"));
  EXPECT_THAT(verdict_sentence(simple(4), 0, 0), HasSubstr("by up to a factor 4.0 ± 0.4 at 14.1 Hz"));
  EXPECT_THAT(verdict_sentence(simple(0.95), 0, 0), HasSubstr("within two standard errors"));
  EXPECT_THAT(verdict_sentence(simple(4), 25, 40), HasSubstr("stays a factor 5.0"));
}

TEST(ReportOutcome, UnresolvedRoutesMakeItALowerBound) {
  NoiseBudget b = simple(0.5);
  b.unresolved = {"ITM·S: too few scores"};
  EXPECT_THAT(verdict_sentence(b, 0, 0), HasSubstr("Stray light observed so far stays"));
  EXPECT_THAT(verdict_sentence(b, 0, 0), HasSubstr("lower bound; unresolved (1): ITM·S: too few scores"));
}

TEST(ReportOutcome, CountsFaintRoutes) {
  NoiseBudget b = simple(0.5);
  b.faint = {"ITM·S > ETM·S: too few scores"};
  EXPECT_THAT(verdict_sentence(b, 0, 0), HasSubstr("1 unresolved route is too faint to matter (nothing on it moves)."));
  b.faint.push_back("ETM·S > ITM·S: too few scores");
  EXPECT_THAT(verdict_sentence(b, 0, 0),
              HasSubstr("2 unresolved routes are too faint to matter (nothing on them moves)."));
}

TEST(ReportOutcome, StatesWhenNoCurveIsGiven) {
  NoiseBudget b = simple(0.5);
  b.design[0].asd = {not_a_number, not_a_number};
  EXPECT_THAT(verdict_sentence(b, 0, 0), HasSubstr("has no values between 10 and 40 Hz"));
  b.design.clear();
  EXPECT_THAT(verdict_sentence(b, 0, 0), HasSubstr("was not compared"));
}

TEST_F(ReportTables, ReportHasItsSections) {
  std::string const text = text_report(content(trace, &noise), table(), 12, {"No polarisation."});
  for (char const* part :
       {"Strain noise", "Routes", "Where the light went", "Light on objects", "Assumptions", "Provenance", "Warnings",
        "C_rev on", "No polarisation.", "flange_17", "arm cavity", "override    n=40", "none seen", "h/adv-lal"})
    EXPECT_THAT(text, HasSubstr(part));
  trace.coupling.reverse_routes = false;
  EXPECT_THAT(text_report(content(trace, nullptr), table(), 12), HasSubstr("Couplings only"));
  EXPECT_THAT(text_report(content(trace, nullptr), table(), 12), HasSubstr("C_rev off"));
}

// Errors of totals hold less often than stated in short runs (docs/theory/blind.md). Controls: enough histories, none.
TEST_F(ReportTables, FewHistoriesAreAWarning) {
  auto const warned = [&](std::uint64_t histories) {
    trace.coupling.histories = histories;
    return text_report(content(trace, &noise), table(), 12).find(" histories are few") != std::string::npos;
  };
  EXPECT_TRUE(warned(8192));
  EXPECT_TRUE(warned(16383));
  EXPECT_FALSE(warned(16384));
  EXPECT_FALSE(warned(0));
}

// Without a resolved route there is no value at a frequency of the band; outside the band no value was requested.
TEST_F(ReportTables, UnresolvedIsNotOutsideTheGrid) {
  auto const count = [&](std::string const& words) {
    std::string const text = text_report(content(trace, &noise), table(), 12);
    int n = 0;
    for (std::size_t at = text.find(words); at != text.npos; at = text.find(words, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("outside the grid"), 1);
  EXPECT_EQ(count("no answer"), 0);
  noise.total.asd.assign(noise.total.asd.size(), not_a_number);
  EXPECT_EQ(count("outside the grid"), 1) << "control: the frequencies of the band";
  EXPECT_EQ(count("no answer"), 1 + 3);  // also in the sentence at the top
}

}  // namespace
}  // namespace straytrace::test
