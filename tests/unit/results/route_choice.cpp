// SPDX-License-Identifier: BSD-3-Clause
// `paths --without` and rows that sum routes: `other`, and ghosts whose fields add, are not divided. What is echoed.
#include "results/route_table/route_choice.hpp"

#include <gmock/gmock.h>

#include "base/errors.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::report_route_choice {
namespace {

using namespace straytrace::test;
using ::testing::HasSubstr, ::testing::Not;

class RouteChoice : public ::testing::Test {
 protected:
  ChosenPaths without(std::vector<std::string> const& patterns) {
    return choose_paths({"", "", patterns}, table, trace.coupling, &noise);
  }
  std::string text(std::vector<std::string> const& patterns) {
    return choice_text({"", "", patterns}, without(patterns));
  }
  std::string error(std::vector<std::string> const& patterns) {
    try {
      without(patterns);
    } catch (InputError const& e) {
      return e.what();
    }
    return "none";
  }
  PathRow& other() {
    return *std::ranges::find_if(table.rows, [](PathRow const& row) { return row.vertices == 0; });
  }
  // The strongest row, as the fields of two ghosts.
  void make_coherent() {
    PathRow& row = table.rows.front();
    row.kind = ClassKind::ghost;
    row.sequence = "ITM·T > lens/front·R > ITM·T and 1 more";
    row.folded_routes = 2;
    row.folded = {{1, "ITM·T > lens/front·R > ITM·T", {2e-20, 0}, true, "added as a field"},
                  {2, "ITM·T > lens/back·R > ITM·T", {1e-20, 0}, true, "added as a field"}};
  }

  TraceResult trace = trace_result();
  NoiseBudget noise = noise_budget(trace.coupling);
  MotionSet shake = test::motion();
  PathTable table = path_table(trace.coupling, &noise, &shake, {{10, 30, 100}, 10, 500, 12});
};

TEST_F(RouteChoice, ControlCharactersAndBrokenLettersAreEscaped) {
  PathsChoice const choice{"\x01\xffµ", "", {}};
  ChosenPaths const chosen = without({});
  EXPECT_THAT(choice_text(choice, chosen), HasSubstr("routes: ??µ\n"));
  EXPECT_THAT(with_choice("{}", choice, chosen), HasSubstr("\\u0001\xef\xbf\xbdµ"));  // not an exception
}

// Routes listed in `other` pass the object: an error says so, or the sums say that they stay. Controls: before, and a
// name that nothing has.
TEST_F(RouteChoice, OtherContainsRoutesThatPass) {
  EXPECT_THAT(error({"mount*"}), HasSubstr("no route passes 'mount*'"));
  EXPECT_THAT(text({"baffles"}), HasSubstr("Some routes in 'other > arm' may pass there"));
  other().folded.push_back({3, "ITM·S > mount·S > baffles·S > ITM·S", {1e-24, 1e-25}, false, "few scores"});
  EXPECT_THAT(error({"mount*"}),
              HasSubstr("routes that pass 'mount*' are only in 'other > arm', which cannot be divided"));
  EXPECT_THAT(error({"mout"}), HasSubstr("did you mean 'mount'?"));
  EXPECT_THAT(text({"baffles"}), HasSubstr("Some routes in 'other > arm' pass there, and stay in the sums"));
  EXPECT_THAT(error({"xyzzy"}), HasSubstr("no route passes 'xyzzy'")) << "control";
}

// A row of fields is left out as a whole or not at all; a factor for a part of it would be wrong. Control: the
// strongest ghost alone is a row that can be left out.
TEST_F(RouteChoice, FieldsAreNotDivided) {
  make_coherent();
  for (char const* face : {"lens/front", "lens/back"})
    EXPECT_THAT(error({face}), HasSubstr("is a coherent sum of ghosts, of which only some pass " + std::string(face)));
  for (std::vector<std::string> const& all : {std::vector<std::string>{"lens/*"}, {"lens/front", "lens/back"}}) {
    EXPECT_EQ(without(all).left_out, 1u);
    EXPECT_THAT(text(all), Not(HasSubstr("and 1 more'")));
  }
  table.rows.front().folded_routes = 3;  // one more is not listed
  EXPECT_THAT(error({"lens/*"}), HasSubstr("cannot be divided"));
  EXPECT_THAT(text({"baffles"}), HasSubstr("'ITM·T > lens/front·R > ITM·T and 1 more', 'other > arm' may pass there"));
  table.rows.front().folded_routes = 0;
  table.rows.front().folded.clear();
  EXPECT_EQ(without({"lens/front"}).left_out, 1u) << "control";
  EXPECT_THAT(error({"lens/back"}), HasSubstr("no route passes 'lens/back'")) << "control";
}

}  // namespace
}  // namespace straytrace::report_route_choice
