// SPDX-License-Identifier: BSD-3-Clause
// Values read off curves: between the centres of bins, in lines, and of upper bounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "results/curves/band.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct ReportReading : ::testing::Test {
  PathTable table() const { return path_table(trace.coupling, &noise, &shake, {{10, 30, 100}, 10, 500, 12}); }
  TraceResult trace = trace_result();
  NoiseBudget noise = noise_budget(trace.coupling);
  MotionSet shake = test::motion();

  void leave_unresolved(std::size_t route) {
    trace.coupling.classes[route].coupling.trusted = noise.routes[route].resolved = noise.total.resolved = false;
    noise.unresolved = {noise.routes[route].name};
  }
  // The strongest route is a bound; all are resolved.
  void edge_among_resolved() {
    for (std::size_t c = 0; c < route_count; ++c) trace.coupling.classes[c].coupling.trusted = true;
    for (NoiseTrace& t : noise.routes) t.resolved = true;
    noise.total.resolved = true;
    noise.unresolved.clear();
    trace.coupling.classes[0].kind = ClassKind::edge;
    find_bounds(noise, trace.coupling);
    EXPECT_GT(noise.total.bound_share[0], 0.1);
  }
};

// Band power of h = a constant: a^2 times the width of the bins inside.
TEST_F(ReportReading, BandPowerIntegratesThePsd) {
  FrequencyGrid const grid{{10, 20, 40, 80}};
  NoiseTrace flat;
  flat.asd = {2, 2, 2};
  flat.sigma = {0.1, 0.1, 0.1};
  WithError const p = band_power(flat, grid, 10, 50);
  EXPECT_DOUBLE_EQ(p.value, 4 * 30);
  EXPECT_DOUBLE_EQ(p.sigma, 2 * 2 * 0.1 * 30);
  EXPECT_TRUE(std::isnan(strain_at(flat, grid, 80).value));
  EXPECT_TRUE(std::isnan(strain_at(flat, grid, 9).value));
  EXPECT_EQ(strain_at(flat, grid, 10).value, 2);
}

// A steep h = 1/f^3 is printed at the requested frequency, not at the centre of the bin that contains it.
TEST_F(ReportReading, StrainIsReadAtTheFrequencyItself) {
  FrequencyGrid const grid = logarithmic_grid(5, 500, 10);
  NoiseTrace steep;
  double nearest = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    steep.asd.push_back(std::pow(grid.centre(i), -3));
    steep.sigma.push_back(0.01 * steep.asd.back());
    if (grid.edges[i] <= 30 && 30 < grid.edges[i + 1]) nearest = steep.asd.back();
  }
  for (double const f : {10.0, 30.0, 100.0}) {
    EXPECT_NEAR(strain_at(steep, grid, f).value * f * f * f, 1, 1e-12);
    EXPECT_NEAR(strain_at(steep, grid, f).sigma * f * f * f, 0.01, 1e-12);
  }
  EXPECT_GT(std::fabs(nearest * 27000 - 1), 0.01);  // the control: the value of the bin
}

// A line fills one bin: at its frequency the value is the mean over that bin, with its rms; the next bin contains
// none of it. Controls: the lower neighbour (0), and straight lines in log-log between the centres.
TEST_F(ReportReading, LinesAreReadFromTheirBin) {
  FrequencyGrid const grid = logarithmic_grid(6, 15, 60);
  auto const own = std::size_t(std::upper_bound(grid.edges.begin(), grid.edges.end(), 10.0) - grid.edges.begin()) - 1;
  ASSERT_LT(10, grid.centre(own));
  for (double const background : {0.0, 1e-26}) {
    NoiseTrace t;
    t.asd.assign(grid.size(), background);
    t.sigma.assign(grid.size(), 0.01 * background);
    t.asd[own] = 1.7e-24;
    t.sigma[own] = 2e-26;
    WithError const at_line = strain_at(t, grid, 10), beside = strain_at(t, grid, 0.999 * grid.edges[own]);
    EXPECT_EQ(at_line.value, 1.7e-24);
    EXPECT_EQ(at_line.sigma, 2e-26);
    EXPECT_EQ(beside.value, background);
    BinLine const line = line_at(t, grid, 10);
    EXPECT_NEAR(line.rms.value, 1.7e-24 * std::sqrt(grid.width(own)), 1e-30);
    EXPECT_EQ(line.low, grid.edges[own]);
    EXPECT_TRUE(std::isnan(line_at(t, grid, 8).rms.value));
    double const x = std::log(10 / grid.centre(own - 1)) / std::log(grid.centre(own) / grid.centre(own - 1));
    double const straight = background * std::pow(1.7e-24 / std::max(background, 1e-300), x);
    EXPECT_GT(std::fabs(straight / at_line.value - 1), 0.3);
    EXPECT_NE(t.asd[own - 1], at_line.value);
  }
  NoiseTrace smooth;
  for (std::size_t i = 0; i < grid.size(); ++i) smooth.asd.push_back(std::pow(grid.centre(i), -9));
  smooth.sigma = smooth.asd;
  EXPECT_NEAR(strain_at(smooth, grid, 10).value, 1e-9, 1e-21);  // no line, however steep
  EXPECT_TRUE(std::isnan(line_at(smooth, grid, 10).rms.value));
}

// Edges are upper bounds: without an error, with two digits, wherever they make a part of the number that shows.
TEST_F(ReportReading, UpperBoundsPrintAtMost) {
  EXPECT_EQ(with_error({2.617193e-26, 4e-32, true}), "at most 2.7e-26");
  EXPECT_EQ(with_error({2.617193e-26, 4e-32}), "2.617193e-26 ± 0.000004e-26");  // negative control
  EXPECT_EQ(with_brackets({9.95, 0.1, true}) + ", " + with_brackets({2.6e-26, 0, true}), "at most 10, at most 2.6e-26");
  EXPECT_EQ(two_digits(198.7, false) + ", " + two_digits(198.7, true), "190, 200");
  std::string const all[] = {path_text(table(), 12), text_report(content(trace, &noise), table(), 12)};
  for (std::string const& text : all) EXPECT_THAT(text, Not(HasSubstr("at most")));  // control: none is
  edge_among_resolved();
  std::string const text = path_text(table(), 12), report = text_report(content(trace, &noise), table(), 12);
  EXPECT_THAT(text, HasSubstr("at most"));
  EXPECT_THAT(report.substr(0, report.find("Routes\n=")), HasSubstr("at most"));
  auto const j = nlohmann::json::parse(summary_json(content(trace, &noise), table()));
  EXPECT_TRUE(j["total_strain"][0]["at_most"]);
  EXPECT_TRUE(j["routes"][0]["coupling"]["at_most"]);
  EXPECT_FALSE(j["routes"][1]["coupling"].contains("at_most"));
  EXPECT_TRUE(j["routes"][0]["share"]["at_most"]);
  EXPECT_EQ(j["bound"], "upper");
  EXPECT_THAT(asd_text(content(trace, &noise)), HasSubstr("# AT MOST"));
}

// A share of a bound is no plain number.
TEST_F(ReportReading, SharesOfUpperBoundsPrintAtMost) {
  edge_among_resolved();
  PathTable const t = table();
  WithError const& share = t.rows[0].share;
  EXPECT_TRUE(share.at_most && !t.rows[1].share.at_most);
  EXPECT_THAT(path_text(t, 12), HasSubstr("  " + percent_text(share) + "  "));
  EXPECT_THAT(percent_text(share), ::testing::StartsWith("at most "));
  EXPECT_THAT(percent_text(t.rows[1].share), HasSubstr("("));  // control: with its error
}

// Upper bounds in it and routes missing from it: no bound, and every output says so; controls: each of both alone.
TEST_F(ReportReading, ATotalThatMixesBothBoundsIsNeither) {
  edge_among_resolved();
  auto const said = [&] {
    RunContent const run = content(trace, &noise);
    std::string const line = path_text(table(), 12), report = text_report(run, table(), 12), asd = asd_text(run);
    auto const j = nlohmann::json::parse(summary_json(run, table()));
    return std::vector<std::string>{line, report.substr(0, report.find("Routes\n=")), asd, j["bound"],
                                    j["total_strain"][0].dump()};
  };
  using ::testing::AllOf;
  using ::testing::ElementsAre;
  EXPECT_THAT(said(), ElementsAre(Not(AnyOf(HasSubstr("lower bound"), HasSubstr("contains"))), HasSubstr("at most"),
                                  HasSubstr("# AT MOST"), "upper", HasSubstr("\"at_most\":true")));
  leave_unresolved(4);
  noise.total.sigma = noise.total.asd;  // of what was seen: it hides no bound
  EXPECT_THAT(said(),
              ElementsAre(AllOf(HasSubstr("total (contains upper bounds; 1 route unresolved)"), HasSubstr("about ")),
                          AllOf(HasSubstr("NO BOUNDS"), HasSubstr("no bound, since"), Not(HasSubstr("at most"))),
                          AllOf(HasSubstr("# NO BOUND:"), HasSubstr("# CONTAINS UPPER BOUNDS: in ")), "neither",
                          AllOf(HasSubstr("\"bound\":\"neither\""), Not(HasSubstr("at_most")))));
  if (noise.bands.made()) {
    EXPECT_THAT(band_summary(noise, {noise.grid.centre(0)}), Not(HasSubstr("of the upper bound")));
  }
  trace.coupling.classes[0].kind = ClassKind::scattered;
  find_bounds(noise, trace.coupling);
  EXPECT_THAT(said(), ElementsAre(HasSubstr("total (lower bound)"), HasSubstr("LOWER BOUNDS"),
                                  HasSubstr("# LOWER BOUND:"), "lower", Not(HasSubstr("bound"))));
}

}  // namespace
}  // namespace straytrace::test
