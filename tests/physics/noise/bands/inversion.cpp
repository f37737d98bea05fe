// SPDX-License-Identifier: BSD-3-Clause
// Requirements from a line, against closed forms (docs/theory/errors.md).
#include "noise/bands/inversion.hpp"

#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_inversion {
namespace {

using Verdict = Allowed::Verdict;
constexpr GroupId mirror{0}, steel{1};

CouplingClass by_steel(std::uint64_t hash, int scatters, double mean, std::uint32_t body = 0) {
  CouplingClass c = known_class(hash, mean, {record(0, mean, {phase_sensitivity(body, 2, two_k)})});
  c.steps.push_back({mirror, Event::emit});
  for (int i = 0; i < scatters; ++i) c.steps.push_back({steel, Event::scatter});
  c.steps.push_back({mirror, Event::couple});
  return c;
}

MaterialSpread material(GroupId group) { return {"m", "", 1, 1, 1, false, {group}}; }
MotionSet linear_motion() {
  return moving({power_law_asd(1e-13, 10, -2, 1, 100), power_law_asd(1e-13, 10, -2, 1, 100)});
}

struct Case {
  CouplingTable table;
  NoiseBudget budget;
};
Case of(std::vector<CouplingClass> classes) {
  Case c{known_table(std::move(classes)), {}};
  c.table.groups = {"mirror", "steel"};
  c.budget = project_noise(c.table, linear_motion(), UnitDetector(), on({9.8, 10.2, 10.6}));
  return c;
}
std::vector<double> times(double factor, std::vector<double> asd) {
  for (double& h : asd) h *= factor;
  return asd;
}

Inversion inverted(Case const& c, MaterialSpread const& material, std::vector<double> const& line) {
  Composition const composition(c.table, {material}, linear_motion(), UnitDetector(), on({9.8, 10.2, 10.6}));
  return invert_scatter(c.budget, composition, line);
}

TEST(Inversion, MirrorsScatterTwiceSoNoiseIsProportional) {  // h ~ beta
  Case const c = of({by_steel(1, 1, 1e-20)});
  Inversion const i = inverted(c, material(mirror), times(0.2, c.budget.total.asd));
  EXPECT_EQ(i.all.verdict, Verdict::found);
  EXPECT_NEAR(i.all.scale, 0.2, 1e-9);
  EXPECT_NEAR(i.touched, 1, 1e-12);
}

TEST(Inversion, OneScatterGoesWithTheRoot) {  // h ~ sqrt(beta)
  Case const c = of({by_steel(1, 1, 1e-20)});
  EXPECT_NEAR(inverted(c, material(steel), times(0.2, c.budget.total.asd)).all.scale, 0.04, 1e-9);
  EXPECT_NEAR(inverted(c, material(steel), times(3, c.budget.total.asd)).all.scale, 9, 1e-7);
}

TEST(Inversion, OrdersAddAsAPolynomial) {  // total(s)^2 = 0.5 + 0.3 s + 0.2 s^2 of the whole
  Case const c = of({by_steel(1, 0, 5e-21), by_steel(2, 1, 3e-21), by_steel(3, 2, 2e-21)});
  Inversion const up = inverted(c, material(steel), times(std::sqrt(1.9), c.budget.total.asd));
  EXPECT_NEAR(up.all.scale, 2, 1e-6);  // 0.5 + 0.6 + 0.8 = 1.9
  Inversion const rest = inverted(c, material(steel), times(0.5, c.budget.total.asd));
  EXPECT_EQ(rest.all.verdict, Verdict::never);
  EXPECT_NEAR(rest.all.rest, std::sqrt(0.5) / 0.5, 1e-9);
}

TEST(Inversion, TheStrictestFrequencyDecides) {
  Case const c = of({by_steel(1, 1, 1e-20)});
  std::vector<double> line = times(2, c.budget.total.asd);
  line[1] *= 0.25;
  Inversion const i = inverted(c, material(mirror), line);
  EXPECT_EQ(i.decides, 1u);
  EXPECT_NEAR(i.bins[0].scale, 2, 1e-9);
  EXPECT_NEAR(i.all.scale, 0.5, 1e-9);
  line[1] = not_a_number;  // no line there
  EXPECT_NEAR(inverted(c, material(mirror), line).all.scale, 2, 1e-9);
}

TEST(Inversion, TheErrorIsThatOfTheTotalOverTheSlope) {  // h known to 3 %, h ~ sqrt(s): s to 6 %, twice for pairs
  Case c = of({by_steel(1, 1, 1e-20)});
  c.budget.routes[0].sigma = times(0.03, c.budget.routes[0].asd);
  Inversion const i = inverted(c, material(steel), times(0.5, c.budget.total.asd));
  EXPECT_NEAR(i.all.sigma / i.all.scale, std::sqrt(2.0) * 0.06, 1e-6);
}

// A row `other` of two routes, of which it names the brightest: without a scatter on steel.
CouplingClass other_row(double mean, std::uint64_t routes = 2) {
  CouplingClass other = by_steel(1, 0, mean);
  other.folded.push_back({1, other.steps, mean, 0, true, ""});
  other.folded_routes = routes;
  other.steps.clear();
  return other;
}

TEST(Inversion, IsUnknownWhereRowsOfUnknownCompositionDecide) {
  auto const answer = [](CouplingClass const& other, double line) {
    Case const c = of({other, by_steel(2, 1, 1e-21)});
    return inverted(c, material(steel), times(line, c.budget.total.asd));
  };
  Inversion const loud = answer(other_row(9e-21), 2);
  EXPECT_EQ(loud.all.verdict, Verdict::unknown);
  EXPECT_EQ(loud.bins[0].verdict, Verdict::unknown);
  EXPECT_NEAR(loud.mixed, 0.9, 1e-9);
  EXPECT_NEAR(loud.touched, 1, 1e-9);                      // at most
  Inversion const known = answer(other_row(9e-21, 1), 2);  // control: its only route is named
  EXPECT_NEAR(known.all.scale, 31, 1e-6);                  // 9 + s = 4 * 10
  EXPECT_NEAR(known.touched, 0.1, 1e-9);
  EXPECT_EQ(answer(other_row(1e-24), 2).all.verdict, Verdict::found);  // control: it carries 0.1 %
}

TEST(Inversion, SetsNoLimitOnlyWhereEveryRouteIsKnown) {
  auto const answer = [](std::uint64_t routes) {
    Case const c = of({other_row(1e-24, routes), by_steel(2, 0, 1e-20)});
    return inverted(c, material(steel), times(10, c.budget.total.asd));
  };
  EXPECT_EQ(answer(2).all.verdict, Verdict::unknown);
  EXPECT_NEAR(answer(2).mixed, 1e-4, 1e-7);
  EXPECT_EQ(answer(1).all.verdict, Verdict::always);  // control
  EXPECT_EQ(answer(1).touched, 0);
}

// A row `other` whose light does not scatter on steel and lies still; the paths of one that does, a hundredth of the
// light, make all of its noise. Control: a file that does not state the routes of the paths.
TEST(Inversion, KnowsRowsOtherByTheNoiseOfTheirPaths) {
  auto const answer = [](bool listed, double line) {
    CouplingClass other = other_row(1e-20);
    PathRecord still = record(0, 9.9e-21, {}), moved = record(1, 1e-22, {phase_sensitivity(0, 2, two_k)});
    other.records = {still, moved};
    if (listed) {
      other.members = {{by_steel(1, 0, 1).steps}, {by_steel(1, 2, 1).steps}};
      for (std::uint32_t i : {0u, 1u}) other.records[i].member = i;
    }
    Case const c = of({other});
    return inverted(c, material(steel), times(line, c.budget.total.asd));
  };
  Inversion const known = answer(true, 4);
  EXPECT_EQ(known.all.verdict, Verdict::found);
  EXPECT_NEAR(known.all.scale, 4, 1e-6);  // two scatters: h ~ s
  EXPECT_NEAR(known.touched, 1, 1e-9);
  EXPECT_EQ(known.mixed, 0);
  EXPECT_FALSE(known.first_order);
  EXPECT_EQ(answer(false, 4).all.verdict, Verdict::unknown) << "control";
  EXPECT_NEAR(answer(false, 4).mixed, 1, 1e-9);
}

// Ghosts whose fields add: all of them count, not the strongest, which names the row. Their fields do not divide its
// power: where they reflect unequally often, the row is not known. Controls: equally often; a BRDF, which no ghost
// sees.
TEST(Inversion, SeesEveryGhostOfACoherentRow) {
  auto const ghost = [](int reflections) {
    std::vector<PathStep> steps{{mirror, Event::transmit}, {steel, Event::transmit}, {mirror, Event::transmit}};
    for (int i = 0; i < reflections; ++i)
      steps[std::size_t(i)].group = steel, steps[std::size_t(i)].event = Event::reflect;
    return steps;
  };
  auto const answer = [&](std::vector<int> const& reflections, bool of_reflection) {
    CouplingClass row = by_steel(1, 0, 1e-20);
    row.kind = ClassKind::ghost;
    row.steps = ghost(reflections.front());
    row.folded_routes = reflections.size();
    for (int const n : reflections) row.folded.push_back({std::uint64_t(n), ghost(n), 5e-21, 0, true, ""});
    Case const c = of({row});
    MaterialSpread lens = material(steel);
    lens.of_reflection = of_reflection;
    return inverted(c, lens, times(3, c.budget.total.asd));
  };
  EXPECT_EQ(answer({1, 3}, true).all.verdict, Verdict::unknown);
  EXPECT_NEAR(answer({1, 3}, true).mixed, 1, 1e-9);
  EXPECT_NEAR(answer({1, 1}, true).all.scale, 9, 1e-6) << "control";
  EXPECT_EQ(answer({1, 3}, false).all.verdict, Verdict::always) << "control";
}

NoiseTrace with_motion(Case const& c, MotionSet const& motion, double scale) {
  return project_noise(c.table, with_scaled_body(motion, BodyId{0}, scale), UnitDetector(), on({9.8, 10.2, 10.6}))
      .total;
}
struct ByMotion : Inversion {
  int projections = 0;
};
ByMotion by_motion(Case const& c, MotionSet const& motion, std::vector<double> const& line, bool every_bin = true) {
  int projections = 0;
  auto const projected = [&](double scale) {
    ++projections;
    return with_motion(c, motion, scale);
  };
  return {invert_motion(projected, line, every_bin), projections};
}

TEST(Inversion, LinearMotionIsProportional) {  // h ~ x
  Case const c = of({by_steel(1, 1, 1e-20)});
  ByMotion const i = by_motion(c, linear_motion(), times(5, c.budget.total.asd));
  EXPECT_LT(deviation(i.all.scale, 5), 1e-4);
  EXPECT_LT(deviation(i.bins[0].scale, 5), 1e-4);
  EXPECT_LE(i.projections, 7);
  EXPECT_EQ(by_motion(c, linear_motion(), times(1e5, c.budget.total.asd)).projections, 8) << "no limit";
}

TEST(Inversion, LightOnOtherBodiesStays) {
  Case const c = of({by_steel(1, 1, 1e-20), by_steel(2, 1, 4e-20, 1)});
  Inversion const i = by_motion(c, linear_motion(), times(0.5, c.budget.total.asd));
  EXPECT_EQ(i.all.verdict, Verdict::never);
  EXPECT_LT(deviation(i.all.rest, std::sqrt(0.8) / 0.5), 1e-3);
  EXPECT_LT(deviation(i.touched, 0.2), 1e-3);
}

// A line of a fringe-wrapped tone rises within an eighth of a decade of the motion and leaves a tenth of its height:
// the first crossing is on the flank.
TEST(Inversion, FindsAPeakWithinHalfADecade) {
  auto const tone = [](double scale) {
    double const from_peak = std::log10(scale) - 0.25;
    return std::max(2 * std::exp(-200 * from_peak * from_peak), from_peak > 0 ? 0.2 : 0);
  };
  auto const projected = [&](double scale) {
    NoiseTrace t;
    t.asd = {scale > 0 ? 1e-3 * scale + tone(scale) : 0};
    t.sigma = {0.01 * t.asd[0]};
    return t;
  };
  Inversion const i = invert_motion(projected, {1});
  ASSERT_EQ(i.all.verdict, Verdict::found);
  EXPECT_LT(deviation(i.all.scale, std::pow(10, 0.25 - std::sqrt(std::log(2) / 200))), 2e-3);
  EXPECT_EQ(invert_motion(projected, {3}).all.verdict, Verdict::always) << "control: a line above the peak";
}

// h saturates once fringes wrap: S has its largest value near sigma_f = f, and falls beyond (eq. 7.8).
TEST(Inversion, WrappedNoiseHasALargestValue) {
  Case const c = of({by_steel(1, 1, 1e-20)});
  MotionSet const motion = moving({gaussian_line(0.35, 0.05, 3e-6), power_law_asd(1e-13, 10, -2, 1, 100)});
  NoiseBudget const wrapped = project_noise(c.table, motion, UnitDetector(), on({9.8, 10.2, 10.6}));
  EXPECT_EQ(by_motion(c, motion, times(3, wrapped.total.asd)).all.verdict, Verdict::always);
  ByMotion const i = by_motion(c, motion, times(0.5, wrapped.total.asd));
  ASSERT_EQ(i.all.verdict, Verdict::found);
  EXPECT_LE(i.projections, 20);
  // The first of all factors in steps of 0.2 % that exceeds the line.
  double first = 0.1;
  auto const meets = [&](double scale) {
    NoiseTrace const t = with_motion(c, motion, scale);
    for (std::size_t k = 0; k < t.asd.size(); ++k)
      if (t.asd[k] > 0.5 * wrapped.total.asd[k]) return false;
    return true;
  };
  while (first < 1 && meets(first)) first *= 1.002;
  EXPECT_LT(deviation(i.all.scale, first), 2e-3);
  ByMotion const one = by_motion(c, motion, times(0.5, wrapped.total.asd), false);
  EXPECT_EQ(one.all.scale, i.all.scale);
  EXPECT_LE(one.projections, i.projections);
  EXPECT_GT(i.all.scale, 0.2);
  EXPECT_LT(i.all.scale, 0.95);  // the first crossing, though larger motion comes below the line again
  Inversion const much = by_motion(c, with_scaled_body(motion, BodyId{0}, 10), times(0.5, wrapped.total.asd));
  EXPECT_LT(deviation(much.all.scale, i.all.scale / 10), 0.02);
}

}  // namespace
}  // namespace straytrace::testing::noise_inversion
