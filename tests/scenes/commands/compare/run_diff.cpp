// SPDX-License-Identifier: BSD-3-Clause
// Rows of two runs are compared where they hold the same light: a route with its own row in one run only is part
// of the row `other` of the other run.
#include "session/compare/run_diff.hpp"

#include "base/every_module.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing::app_run_diff {
namespace {

using ::testing::HasSubstr;

struct Row {
  std::vector<std::uint32_t> steps;  // groups; empty: `other`
  double h;                          // 1/sqrt(Hz), its error 2 %
};

RunFile run_of(std::uint64_t seed, std::vector<std::string> groups, std::vector<Row> const& rows) {
  RunFile run;
  run.trace.coupling.seed = seed;
  run.trace.coupling.groups = std::move(groups);
  run.trace.coupling.ports = {"ITM"};
  run.noise.emplace();
  run.noise->grid.edges = {10, 20};
  auto const trace = [](double h) {
    NoiseTrace t;
    t.asd = {h};
    t.sigma = {0.02 * h};
    return t;
  };
  double power = 0;
  for (Row const& row : rows) {
    CouplingClass c;
    c.port = {0};
    c.hash = 1;
    for (std::uint32_t const group : row.steps) {
      c.steps.push_back({{group}, Event::scatter});
      c.hash = 10 * c.hash + group;
    }
    NoiseTrace t = trace(row.h);
    t.hash = c.hash;
    t.name = route_name(run.trace.coupling, c);
    run.noise->routes.push_back(t);
    run.trace.coupling.classes.push_back(c);
    power += row.h * row.h;
  }
  run.noise->total = trace(std::sqrt(power));
  return run;
}

Change const& row(RunDifference const& d, std::string const& begin) {
  for (Change const& c : d.routes)
    if (c.what.starts_with(begin)) return c;
  ADD_FAILURE() << "no row " << begin;
  return d.routes.front();
}

std::vector<std::string> const groups = {"ITM", "wall", "tube"};
RunFile const before = run_of(1, groups, {{{0, 1, 0}, 1e-22}, {{}, 5e-23}});

// A change far below its error has no sign; control: one of more than half a digit keeps it.
TEST(RunDiff, NoMinusZero) {
  auto const text = [](double h) {
    return run_difference_text(run_differences(before, run_of(2, groups, {{{0, 1, 0}, h}, {{}, 5e-23}})));
  };
  EXPECT_THAT(text(0.9999e-22), ::testing::AllOf(HasSubstr("  0.0 sigma"), ::testing::Not(HasSubstr("-0.0 sigma"))));
  EXPECT_THAT(text(0.98e-22), HasSubstr("-0.7 sigma"));
}

// Shared spectra do not resolve a change of 1e-4: the line states both. Control: a change of 1 %.
TEST(RunDiff, TheLimitOfChangesIsStated) {
  auto const text = [](double h) {
    return run_difference_text(run_differences(before, run_of(1, groups, {{{0, 1, 0}, h}, {{}, 5e-23}})));
  };
  EXPECT_THAT(text(1.0001e-22), HasSubstr("less than the error of the spectra"));
  EXPECT_THAT(text(1.01e-22), ::testing::Not(HasSubstr("error of the spectra")));
}

// 5^2 = 3^2 + 4^2: nothing has changed. Control: `other` against `other` alone, 8 standard errors.
TEST(RunDiff, ARouteOutOfOtherIsNoChange) {
  RunFile const after = run_of(2, groups, {{{0, 1, 0}, 1e-22}, {{0, 2, 0}, 3e-23}, {{}, 4e-23}});
  RunDifference const d = run_differences(before, after), back = run_differences(after, before);
  for (RunDifference const* one : {&d, &back}) {
    Change const &route = row(*one, "ITM·S > tube"), &rest = row(*one, "other > ITM");
    EXPECT_EQ(route.within, "other > ITM");
    EXPECT_TRUE(std::isnan(route.sigmas()));
    EXPECT_EQ(rest.what, "other > ITM and 1 route of one run");
    EXPECT_LT(std::fabs(rest.sigmas()), 1e-6);
    EXPECT_EQ(one->routes.size(), 3u) << "each row once";
  }
  EXPECT_THAT(run_difference_text(d), HasSubstr("compared within 'other > ITM'"));
  EXPECT_GT(std::fabs(5e-23 - 4e-23) / std::hypot(0.02 * 5e-23, 0.02 * 4e-23), 7) << "negative control";
}

// A route that the grid holds in one run and not in the other is one row, and never within `other`, which holds
// scattered light alone. Controls: scattered light, and a route whose kind is the same.
TEST(RunDiff, ARouteOfAnotherKindIsNamed) {
  auto const of_kind = [](std::uint64_t seed, double h, ClassKind kind, std::uint64_t id) {
    RunFile run = run_of(seed, groups, {{{0, 1, 0}, h}, {{}, 5e-23}});
    run.trace.coupling.classes[0].kind = kind;
    run.trace.coupling.classes[0].hash = run.noise->routes[0].hash = id;
    return run;
  };
  RunFile const wave = of_kind(1, 1e-22, ClassKind::wave, 11), speckle = of_kind(2, 3e-22, ClassKind::speckle, 12);
  RunDifference const d = run_differences(wave, speckle);
  ASSERT_EQ(d.routes.size(), 2u);
  Change const& route = row(d, "ITM·S > wall·S > ITM·S");
  EXPECT_EQ(route.what, "ITM·S > wall·S > ITM·S (wave -> speckle)");
  EXPECT_EQ(route.within, "");
  EXPECT_GT(route.after.value / route.before.value, 2.9);
  EXPECT_EQ(row(run_differences(wave, of_kind(2, 3e-22, ClassKind::wave, 11)), "ITM·S > wall").what,
            "ITM·S > wall·S > ITM·S");
  RunFile const none = run_of(2, groups, {{{}, 5e-23}});
  EXPECT_EQ(row(run_differences(wave, none), "ITM·S > wall").within, "");
  EXPECT_EQ(row(run_differences(of_kind(1, 1e-22, ClassKind::scattered, 11), none), "ITM·S > wall").within,
            "other > ITM");
}

// A new object before the others gives them new numbers, and routes new ids: one may be that of another route. They are
// compared by name. Control: the same ids with other names of the objects.
TEST(RunDiff, NewNumbersOfObjects) {
  RunFile const x = run_of(1, {"ITM", "wall", "tube"}, {{{0, 1, 0}, 1e-22}, {{0, 2, 0}, 4e-23}}),
                y = run_of(2, {"ITM", "new", "wall", "tube"}, {{{0, 2, 0}, 1e-22}, {{0, 3, 0}, 4e-23}});
  EXPECT_EQ(x.trace.coupling.classes[1].hash, y.trace.coupling.classes[0].hash) << "control";
  RunDifference const d = run_differences(x, y);
  EXPECT_EQ(d.routes.size(), 2u);
  for (Change const& c : d.routes) EXPECT_EQ(c.before.value, c.after.value) << c.what;
  RunFile other = y;
  other.trace.coupling.groups = {"ITM", "wall", "tube"};
  EXPECT_GT(row(run_differences(x, other), "ITM·S > tube").after.value, 2e-22) << "control";
}

// The ids of rows of ghosts name numbers of objects, and of a sum its strongest ghost. Control: a scattered route.
TEST(RunDiff, GhostsAreComparedByName) {
  auto const run = [](std::uint64_t seed, ClassKind kind, std::uint64_t id, bool swapped) {
    RunFile r = run_of(seed, groups, {{{0, 1, 0}, 1e-22}, {{0, swapped ? 1u : 2u, 2}, 4e-23}, {{0, 2, 0}, 0}});
    for (std::size_t i : {0, 1, 2}) {
      CouplingClass& c = r.trace.coupling.classes[i];
      c.kind = kind;
      c.hash = r.noise->routes[i].hash = id + i;
      if (i != 1) continue;
      c.folded_routes = 5;
      r.noise->routes[i].name = route_name(r.trace.coupling, c);
    }
    return r;
  };
  RunDifference const d = run_differences(run(1, ClassKind::ghost, 11, false), run(2, ClassKind::ghost, 21, true));
  EXPECT_EQ(d.routes.size(), 3u);
  for (Change const& c : d.routes) EXPECT_EQ(c.before.value, c.after.value) << c.what;
  EXPECT_EQ(row(d, "weaker ghosts at ITM").before.value, row(d, "weaker ghosts at ITM").after.value);
  std::string const text = run_difference_text(d);
  EXPECT_THAT(text, ::testing::Not(HasSubstr("none")));
  EXPECT_THAT(text, HasSubstr("still -> still"));
  EXPECT_THAT(run_difference_text(
                  run_differences(run(1, ClassKind::scattered, 11, false), run(2, ClassKind::scattered, 21, true))),
              HasSubstr("none"))
      << "control";
}

// Old files name `other` by the least id of its routes: it varies, and may be that of a route of the other run. Rows
// `other` are compared with each other, those of each C_rev, and nothing is compared with none. Controls: a route that
// only one of the runs can have, and the ids differ.
TEST(RunDiff, OtherIsComparedWithOtherWhateverItsId) {
  auto const run = [](std::uint64_t seed, std::uint64_t id) {
    RunFile r = run_of(seed, groups, {{{0, 1, 0}, 1e-22}, {{}, 5e-23}, {{}, 3e-23}});
    for (std::size_t i : {1, 2}) {
      r.trace.coupling.classes[i].reverse = double(i);
      r.trace.coupling.classes[i].hash = r.noise->routes[i].hash = id + i;
    }
    return r;
  };
  RunFile const x = run(1, 500), y = run(2, run_of(1, groups, {{{0, 1, 0}, 1}}).trace.coupling.classes[0].hash - 1);
  EXPECT_NE(x.noise->routes[1].hash, y.noise->routes[1].hash) << "control";
  EXPECT_EQ(y.noise->routes[1].hash, y.noise->routes[0].hash) << "control";
  RunDifference const d = run_differences(x, y);
  EXPECT_EQ(d.routes.size(), 3u);
  for (Change const& c : d.routes) EXPECT_EQ(c.sigmas(), 0) << c.what;
  EXPECT_THAT(run_difference_text(d), ::testing::Not(HasSubstr("none")));

  RunFile z = run_of(3, groups, {{{0, 1, 0}, 1e-22}, {{0, 2, 0}, 5e-23}, {{}, 3e-23}});
  RunDifference const e = run_differences(x, z);  // 5^2 + 3^2 in both: each row of `other` once
  EXPECT_EQ(e.routes.size(), 3u);
  EXPECT_LT(std::fabs(row(e, "other > ITM and 1 route").sigmas()), 1e-6);
  z.trace.coupling.groups = {"ITM", "wall", "plate"};
  EXPECT_THAT(run_difference_text(run_differences(x, z)), HasSubstr("none")) << "control";
}

// A group with an upper bound and an unresolved member is no bound; controls: either alone.
TEST(RunDiff, AGroupOfBothBoundsIsNeither) {
  auto const group = [](bool bound, bool unresolved) {
    RunFile after = run_of(2, groups, {{{0, 1, 0}, 1e-22}, {{0, 2, 0}, 3e-23}, {{}, 4e-23}});
    after.noise->routes[1].upper_bound = bound;
    after.noise->routes[2].resolved = !unresolved;
    Change const c = row(run_differences(before, after), "other > ITM");
    EXPECT_EQ(c.bound, unresolved);
    return with_error(c.after);
  };
  EXPECT_EQ(group(true, true), "about 1.6e-22");  // 5e-23 times the root of 10 Hz
  EXPECT_EQ(group(true, false), "at most 1.6e-22");
  EXPECT_THAT(group(false, true), HasSubstr("±"));
}

// The light in `other` rises, with and without a route that got its own row. Control: it rises by less than its
// error.
TEST(RunDiff, AChangeInsideOtherIsAChange) {
  auto const sigmas = [](std::vector<Row> rows) {
    rows.push_back({{0, 1, 0}, 1e-22});
    return row(run_differences(before, run_of(2, groups, rows)), "other > ITM").sigmas();
  };
  EXPECT_GT(sigmas({{{}, 7e-23}}), 8);
  EXPECT_GT(sigmas({{{0, 2, 0}, 3e-23}, {{}, 6e-23}}), 8);
  EXPECT_LT(sigmas({{{0, 2, 0}, 3e-23}, {{}, 2e-23}}), -5);
  EXPECT_LT(std::fabs(sigmas({{{}, 5.1e-23}})), 1) << "negative control";
}

// A route by a surface that the other run has not is a separate change, and `other` is unchanged.
TEST(RunDiff, ANewSurfaceIsNotWithinOther) {
  RunFile const after =
      run_of(2, {"ITM", "wall", "tube", "baffle"}, {{{0, 1, 0}, 1e-22}, {{0, 3, 0}, 3e-23}, {{}, 5e-23}});
  RunDifference const d = run_differences(before, after);
  EXPECT_GT(row(d, "ITM·S > baffle").sigmas(), 40);
  EXPECT_EQ(row(d, "other > ITM").sigmas(), 0);
}

}  // namespace
}  // namespace straytrace::testing::app_run_diff
