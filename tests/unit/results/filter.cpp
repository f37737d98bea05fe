// SPDX-License-Identifier: BSD-3-Clause
// Filters of the path table (docs/reference/filter.md), and sums of some of its rows.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <set>

#include "results/curves/band.hpp"
#include "results/route_table/route_filter.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/text/columns.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::report_filter {
namespace {

using namespace straytrace::test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Rows = std::vector<std::size_t>;

class ReportFilter : public ::testing::Test {
 protected:
  FilterAnswer ask(std::string const& text) { return filtered(text, columns); }
  Rows rows(std::string const& text) {
    FilterAnswer const answer = ask(text);
    for (FilterProblem const& p : answer.problems) ADD_FAILURE() << text << ": " << p.what;
    return answer.rows;
  }
  // Those of which a test of the row is true.
  template <class Test>
  Rows those(Test test) const {
    Rows all;
    for (std::size_t i = 0; i < table.rows.size(); ++i)
      if (test(table.rows[i])) all.push_back(i);
    return all;
  }

  TraceResult trace = trace_result();
  NoiseBudget noise = noise_budget(trace.coupling);
  MotionSet shake = test::motion();
  PathTable table = path_table(trace.coupling, &noise, &shake, {{10, 30, 100}, 10, 500, 12});
  RouteColumns columns{table, &noise};
};

bool meets(PathRow const& row, std::string const& name) {
  auto const objects = objects_of(row.sequence);
  return std::find(objects.begin(), objects.end(), name) != objects.end();
}

TEST_F(ReportFilter, selects_the_matching_rows) {
  Rows const via = those([](PathRow const& r) { return meets(r, "baffles"); });
  ASSERT_FALSE(via.empty());
  ASSERT_LT(via.size(), table.rows.size());
  EXPECT_EQ(rows("via(\"baf*\")"), via);
  EXPECT_EQ(rows("VIA('baffles', 'nothing')"), via);
  EXPECT_EQ(rows("not (not via(\"baffles\"))"), via);
  EXPECT_EQ(rows("baffles"), via);  // plain words
  EXPECT_EQ(rows("  ").size(), table.rows.size());
  EXPECT_EQ(rows("resolved"), those([](PathRow const& r) { return r.resolved; }));
  EXPECT_EQ(rows("not resolved"), those([](PathRow const& r) { return !r.resolved; }));
  EXPECT_EQ(rows("share >= 10 % and rank < 3 or rank == 5"),
            those([](PathRow const& r) { return (r.share.value >= 0.1 && r.rank < 3) || r.rank == 5; }));
  EXPECT_EQ(rows("rank == 5 or rank < 3 and share >= 10 %"), rows("(share >= 10 % and rank < 3) or rank == 5"));
  EXPECT_NE(rows("rank == 5 or rank == 1 and rank == 9"),
            rows("(rank == 5 or rank == 1) and rank == 9"));  // negative control
}

// A row of ghosts whose fields add is named by the strongest; light meets what any of them meets. Control: a row
// `other` lists the largest of its routes, and passes no object.
TEST_F(ReportFilter, via_sees_every_ghost_of_a_coherent_row) {
  std::size_t const first = 0, other = those([](PathRow const&r) { return r.vertices == 0; }).at(0);
  for (std::size_t const row : {first, other}) {
    table.rows[row].folded_routes = 2;
    table.rows[row].folded = {{1, "ITM·T > lens/front·R > ITM·T", {2e-20, 0}, true, "added as a field"},
                              {2, "ITM·T > lens/back·R > ITM·T", {1e-20, 0}, true, "added as a field"}};
  }
  columns = RouteColumns(table, &noise);
  EXPECT_EQ(rows("via(\"lens/back\")"), Rows{first});
  EXPECT_EQ(rows("via(\"lens/front\") and via(\"lens/back\")"), Rows{first});
  EXPECT_THAT(rows("via(\"lens\")"), IsEmpty());
  Rows const all = rows("via(\"*\")");
  EXPECT_EQ(std::ranges::count(all, other), 0);
}

// A number means the same in every unit; without a unit nothing is guessed.
TEST_F(ReportFilter, units) {
  double const half = table.rows[1].length_mean;
  Rows const longer = those([&](PathRow const& r) { return r.length_mean > half * 1.001; });
  ASSERT_FALSE(longer.empty());
  EXPECT_EQ(rows(fmt::format("opl > {} m", half * 1.001)), longer);
  EXPECT_EQ(rows(fmt::format("opl>{}km", half * 1.001e-3)), longer);
  EXPECT_EQ(rows(fmt::format("delay > {} us", half * 1.001e6 / speed_of_light)), longer);
  EXPECT_NE(rows(fmt::format("opl > {} km", half * 1.001)), longer);  // control: a unit that is not read
  EXPECT_EQ(rows("share > 10 %"), rows("share > 100000 ppm"));
  EXPECT_EQ(rows("coupling > 1e-20"), rows("coupling > 1e-18 %"));
}

// h at any frequency of the grid is that of the curves; unresolved rows are never let through by a number.
TEST_F(ReportFilter, strain_at_any_frequency) {
  std::size_t const before = columns.all().size();
  Rows loud;
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    for (NoiseTrace const& t : noise.routes)
      if (t.hash == table.rows[i].hash && table.rows[i].resolved && strain_at(t, noise.grid, 47.5).value > 1e-25)
        loud.push_back(i);
  ASSERT_FALSE(loud.empty());
  ASSERT_LT(loud.size(), table.rows.size() - 1);
  EXPECT_EQ(rows("h(47.5 Hz) > 1e-25"), loud);
  EXPECT_EQ(rows("h(0.0475 kHz) > 1e-25/sqrt(Hz)"), loud);
  EXPECT_EQ(columns.all().size(), before + 1);
  EXPECT_EQ(rows("h(30 Hz) > 0").size() + rows("not resolved").size(), table.rows.size());
  EXPECT_THAT(rows("not resolved and (coupling > 0 or coupling <= 0 or coupling != 0)"), IsEmpty());
}

std::string first_error(FilterAnswer const& answer, std::string const& text) {
  FilterProblem const& p = answer.problems.at(0);
  return fmt::format("column {}: {}: {}", width_of(text.substr(0, p.begin)) + 1, p.what, p.suggestion);
}

RouteColumn column_of(nlohmann::json const& j) {
  RouteColumn c;
  c.key = j["key"];
  c.title = j["title"];
  c.unit = j["unit"];
  c.is_text = !j.contains("units");
  for (auto const& value : j["values"])
    if (c.is_text)
      c.texts.push_back(value);
    else
      c.numbers.push_back(value.is_null() ? not_a_number : value.get<double>());
  if (c.is_text) return c;
  c.units = j["units"].get<std::vector<std::pair<std::string, double>>>();
  c.whole = j["whole"];
  c.needs_unit = j["needs_unit"];
  return c;
}

// One table of cases for the program and for pages: tests/tools/report/test_filter.py runs the script of the page on
// it.
TEST(ReportFilterCases, chooses_and_rejects_as_pages_do) {
  auto const cases = nlohmann::json::parse(read_file(STRAY_SOURCE_DIR "/tests/support/filter_cases.json"));
  std::vector<RouteColumn> list;
  for (auto const& column : cases["table"]["columns"]) list.push_back(column_of(column));
  RouteColumns columns(list);
  std::set<Rows> chosen;
  for (auto const& c : cases["chooses"]) {
    FilterAnswer const answer = filtered(c["filter"].get<std::string>(), columns);
    EXPECT_THAT(answer.problems, IsEmpty()) << c;
    Rows ranks;
    for (std::size_t const row : answer.rows) ranks.push_back(row + 1);
    EXPECT_EQ(ranks, c["rows"].get<Rows>()) << c;
    chosen.insert(ranks);
  }
  EXPECT_GT(chosen.size(), 10u);  // negative control: conditions differ in what they choose
  for (auto const& c : cases["rejects"]) {
    std::string const text = c["filter"];
    FilterAnswer const answer = filtered(text, columns);
    ASSERT_FALSE(answer.problems.empty()) << c;
    EXPECT_EQ(first_error(answer, text), c["error"]) << c;
    EXPECT_THAT(answer.rows, IsEmpty()) << c;
  }
}

TEST_F(ReportFilter, h_is_known_on_the_grid) {
  std::string const text = "h(7 MHz) > 1";
  EXPECT_THAT(first_error(ask(text), text), HasSubstr("column 3: h is not known there: h is known from 5 Hz"));
}

TEST_F(ReportFilter, several_mistakes_are_reported_at_once_with_carets) {
  std::string const text = "last(\"µ\") and scaters == 2 and share > 5 and opl < 3 s";
  std::string shown;
  for (FilterProblem const& p : ask(text).problems)
    shown += error_in_filter("--where", text, p).what() + std::string("\n");
  EXPECT_EQ(shown,
            "error: --where, column 15: 'scaters' is not known\n"
            "  last(\"µ\") and scaters == 2 and share > 5 and opl < 3 s\n"
            "                ^^^^^^^ did you mean 'scatters'?\n"
            "error: --where, column 40: share needs a unit\n"
            "  last(\"µ\") and scaters == 2 and share > 5 and opl < 3 s\n"
            "                                         ^ write 5 %\n"
            "error: --where, column 54: 's' is not a unit of opl\n"
            "  last(\"µ\") and scaters == 2 and share > 5 and opl < 3 s\n"
            "                                                       ^ write m, km, cm, mm, um, nm, in\n");
  // In JSON the place is in its fields, and the sentences are plain.
  auto const json = nlohmann::json::parse(problems_as_json(error_in_filter("--where", text, ask(text).problems.at(0))));
  EXPECT_EQ(json.at(0)["file"], "--where");
  EXPECT_EQ(json.at(0)["column"], 15);
  EXPECT_EQ(json.at(0)["width"], 7);
  EXPECT_EQ(json.at(0)["what"], "'scaters' is not known");
  EXPECT_EQ(json.at(0)["suggestion"], "did you mean 'scatters'?");
  EXPECT_THAT(ask("share > 5,5 % and opl > 3,2 m").problems, ::testing::SizeIs(1));  // the first ends the reading
  for (std::string const number : {"1e999", "1e-999"})
    EXPECT_THAT(ask("share > " + number + " %").problems.at(0).what,
                HasSubstr("'" + number + "' is outside the range of double precision"));
  EXPECT_THAT(ask("share\xc2\xa0>\xe2\x80\xaf"
                  "5\xe2\x80\x89%")
                  .problems,
              IsEmpty());
  std::string const deep = std::string(100000, '(') + "resolved";
  EXPECT_THAT(ask(deep).problems.at(0).what, HasSubstr("too deeply"));
  EXPECT_THAT(ask("via(\"bafles\")").notes, ElementsAre("no route has via(\"bafles\"); did you mean \"baffles\"?"));
}

TEST_F(ReportFilter, sorts_with_the_unknown_last) {
  Rows all(table.rows.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  Rows const by_length = sorted_by("opl", all, columns).rows;
  for (std::size_t i = 0; i + 1 < by_length.size(); ++i)
    EXPECT_GE(table.rows[by_length[i]].length_mean, table.rows[by_length[i + 1]].length_mean);
  EXPECT_NE(by_length, all);
  EXPECT_FALSE(table.rows[sorted_by("h(50 Hz)", all, columns).rows.back()].resolved);
  EXPECT_EQ(sorted_by("rank", all, columns).rows, all);
  EXPECT_EQ(sorted_by("shar", all, columns).problems.at(0).suggestion, "did you mean 'share'?");
}

// Without omissions: the total. With omitted routes: h_rest^2 = h^2 - sum of h_i^2, since routes add in power
// (docs/theory/spectra.md).
TEST_F(ReportFilter, sums_without_some_routes) {
  Without const same = without_rows(table, {}, trace.coupling, &noise);
  Rows const out = rows("via(\"baffles\")");
  Without const less = without_rows(table, out, trace.coupling, &noise);
  ASSERT_EQ(less.rest.rows.size() + out.size(), table.rows.size());
  for (std::size_t k = 0; k < table.frequencies.size(); ++k) {
    EXPECT_NEAR(same.strain[k].after.value / same.strain[k].before.value, 1, 1e-12);
    EXPECT_NEAR(same.strain[k].factor.value, 1, 1e-12);
    EXPECT_NEAR(same.strain[k].factor.sigma, 0, 1e-9);  // the whole of itself has no error
    double square = std::pow(table.total_strain[k].value, 2), linear = table.total_strain[k].value;
    for (std::size_t const i : out) {
      double const h = table.rows[i].resolved ? table.rows[i].strain[k].value : table.rows[i].hint[k];
      square -= h * h;
      linear -= h;
    }
    EXPECT_NEAR(less.strain[k].after.value / std::sqrt(square), 1, 2e-3);  // curves are read between bins
    EXPECT_GT(std::fabs(less.strain[k].after.value / linear - 1), 0.02);   // control: amplitudes that add up
    EXPECT_GT(less.strain[k].after.sigma, 0);
  }
  double shares = 0;
  for (PathRow const& row : less.rest.rows)
    if (row.resolved) shares += row.share.value;
  EXPECT_NEAR(shares, 1, 1e-12);
  EXPECT_EQ(less.rest.rows.front().rank, 1u);
  Rows all(table.rows.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  EXPECT_TRUE(std::isnan(without_rows(table, all, trace.coupling, &noise).strain[0].after.value));
}

TEST_F(ReportFilter, a_part_keeps_its_shares_of_the_whole) {
  PathTable const part = part_of(table, rows("rank >= 2"));
  EXPECT_EQ(part.rows.front().rank, 2u);
  EXPECT_EQ(part.rows.front().share.value, table.rows[1].share.value);
  std::string const text = path_text(part, 12, table);
  EXPECT_THAT(text, HasSubstr(fmt::format("{} shown routes", part.rows.size() - part.unresolved)));
  EXPECT_THAT(text, ::testing::Not(HasSubstr(" 100 ")));
}

}  // namespace
}  // namespace straytrace::report_filter
