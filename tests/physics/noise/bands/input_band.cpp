// SPDX-License-Identifier: BSD-3-Clause
// Effect of uncertain scatter and motion on the total, against closed forms (docs/theory/errors.md).
#include "noise/bands/input_band.hpp"

#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_input_band {
namespace {

constexpr GroupId mirror{0}, steel{1};
Spectrum linear_motion() { return power_law_asd(1e-13, 10, -2, 1, 100); }

// mirror > steel (n times) > mirror
CouplingClass by_steel(std::uint64_t hash, int scatters, double mean) {
  CouplingClass c = known_class(hash, mean, {record(0, mean, {phase_sensitivity(0, 2, two_k)})});
  c.steps.push_back({mirror, Event::emit});
  for (int i = 0; i < scatters; ++i) c.steps.push_back({steel, Event::scatter});
  c.steps.push_back({mirror, Event::couple});
  return c;
}

CouplingTable table_of(std::vector<CouplingClass> classes) {
  CouplingTable t = known_table(std::move(classes));
  t.groups = {"mirror", "steel"};
  return t;
}

NoiseBudget banded(CouplingTable const& table, MotionSet const& motion, std::vector<MaterialSpread> const& materials) {
  NoiseBudget b = project_noise(table, motion, UnitDetector(), on({10, 10.4}));
  add_input_band(b, table, motion, UnitDetector(), on({10, 10.4}), materials);
  return b;
}

double low(NoiseBudget const& b) { return b.bands.input_low.at(0) / b.total.asd.at(0); }
double high(NoiseBudget const& b) { return b.bands.input_high.at(0) / b.total.asd.at(0); }

MaterialSpread bracket(std::string const& name, GroupId group, double from, double to) {
  return {name, "", from, to, 1, false, {group}};
}
MaterialSpread one_sigma(std::string const& name, GroupId group, double factor) {
  return {name, "", 1, 1, factor, false, {group}};
}

TEST(InputBand, ARouteScalesWithThePowerOfItsScatters) {  // coupling ~ beta^n, h ~ beta^(n/2)
  for (int const n : {1, 2, 3}) {
    NoiseBudget const b =
        banded(table_of({by_steel(1, n, 1e-20)}), moving({linear_motion()}), {bracket("steel", steel, 0.25, 4)});
    EXPECT_NEAR(high(b), std::pow(2.0, n), 1e-9) << n;
    EXPECT_NEAR(low(b), std::pow(0.5, n), 1e-9) << n;
  }
}

TEST(InputBand, TwoMirrorsScatterTwice) {  // h ~ beta of the mirror: emitted and received by the same law
  NoiseBudget const b =
      banded(table_of({by_steel(1, 1, 1e-20)}), moving({linear_motion()}), {bracket("hr", mirror, 0.5, 2)});
  EXPECT_NEAR(high(b), 2, 1e-9);
}

TEST(InputBand, BracketsGoTogetherAndSigmasInQuadrature) {
  CouplingTable const table = table_of({by_steel(1, 1, 1e-20)});
  MotionSet const motion = moving({linear_motion()});
  NoiseBudget const brackets = banded(table, motion, {bracket("hr", mirror, 0.5, 2), bracket("steel", steel, 0.25, 4)});
  EXPECT_NEAR(high(brackets), 2 * 2, 1e-9);  // correlated along the route
  NoiseBudget const sigmas = banded(table, motion, {one_sigma("hr", mirror, 1.5), one_sigma("steel", steel, 2)});
  double const expected = std::exp(std::hypot(std::log(1.5), 0.5 * std::log(2.0)));
  EXPECT_NEAR(high(sigmas), expected, 1e-9);
  EXPECT_NEAR(low(sigmas), 1 / expected, 1e-9);
  EXPECT_LT(high(sigmas), 1.5 * std::sqrt(2.0));  // control: added like brackets
  EXPECT_NEAR(sigmas.routes[0].input_high[0] / sigmas.routes[0].asd[0], expected, 1e-9);
}

TEST(InputBand, OnlyRoutesThatPassAreScaled) {
  NoiseBudget const b = banded(table_of({by_steel(1, 1, 1e-20), by_steel(2, 0, 3e-20)}), moving({linear_motion()}),
                               {bracket("steel", steel, 0.25, 4)});
  EXPECT_NEAR(high(b), std::sqrt((4 + 3) / 4.0), 1e-9);
  EXPECT_NEAR(b.routes[0].input_high[0] / b.routes[0].asd[0], 2, 1e-9);  // each route separately
  EXPECT_NEAR(b.routes[0].input_low[0] / b.routes[0].asd[0], 0.5, 1e-9);
  EXPECT_EQ(b.routes[1].input_high[0], b.routes[1].asd[0]);
  ASSERT_EQ(b.bands.sources.size(), 1u);
  EXPECT_NEAR(b.bands.sources[0].share, 0.25, 1e-9);
}

TEST(InputBand, OtherIsScaledAsItsNamedRoutes) {
  CouplingClass other = by_steel(1, 1, 1e-20);
  other.steps.clear();
  other.folded.push_back({1, by_steel(1, 1, 1).steps, 3e-21, 0, true, ""});
  other.folded.push_back({2, by_steel(2, 2, 1).steps, 1e-21, 0, true, ""});
  EXPECT_NEAR(coupling_factor(bracket("steel", steel, 1, 4), other, 4), (3 * 4 + 16) / 4.0, 1e-12);
  other.folded.clear();
  EXPECT_EQ(coupling_factor(bracket("steel", steel, 1, 4), other, 4), 4);
}

// A row `other` of `routes` routes that names some, with these numbers of scatters on steel; its noise is that of the
// whole row.
CouplingClass other_row(double mean, std::vector<int> const& scatters, std::uint64_t routes) {
  CouplingClass other = by_steel(1, 1, mean);
  other.steps.clear();
  other.folded_routes = routes;
  for (int const n : scatters) other.folded.push_back({std::uint64_t(n), by_steel(1, n, 1).steps, mean, 0, true, ""});
  return other;
}

// The named routes of a row `other` are the brightest, not those that carry its noise.
TEST(InputBand, IsUnknownWhereRowsOfUnknownCompositionCarryTheNoise) {
  MaterialSpread const uncertain = bracket("steel", steel, 0.25, 4);
  auto const with = [&](CouplingClass const& other) {
    return banded(table_of({other, by_steel(2, 1, 5e-21)}), moving({linear_motion()}), {uncertain});
  };
  for (CouplingClass const& other : {other_row(1e-20, {0}, 2), other_row(1e-20, {0, 1}, 2), other_row(1e-20, {}, 1)}) {
    NoiseBudget const b = with(other);
    EXPECT_TRUE(std::isnan(b.bands.input_low[0]) && std::isnan(b.bands.input_high[0]));
    EXPECT_TRUE(std::isnan(b.routes[0].input_high[0]));
    EXPECT_NEAR(b.routes[1].input_high[0] / b.routes[1].asd[0], 2, 1e-9);
    ASSERT_EQ(b.bands.sources.size(), 1u);
    EXPECT_TRUE(std::isnan(b.bands.sources[0].low) && std::isnan(b.bands.sources[0].share));
  }
  NoiseBudget const known = with(other_row(1e-20, {1, 1}, 2));  // control: all its routes scatter once
  EXPECT_NEAR(high(known), 2, 1e-9);
  EXPECT_NEAR(known.routes[0].input_high[0] / known.routes[0].asd[0], 2, 1e-9);
  NoiseBudget const faint = with(other_row(1e-22, {0}, 2));  // control: it carries 2 %
  EXPECT_LT(deviation(high(faint), 2), 0.02);
  EXPECT_TRUE(std::isnan(faint.routes[0].input_high[0]));
}

// Of a row `other`, the light that lies still does not scatter on steel; faint paths that move scatter once and twice
// and make its noise in equal parts: x 4 and x 16 in power. Control: without the routes of the paths it is not known.
TEST(InputBand, RowsOtherAreDividedByTheNoiseOfTheirPaths) {
  MaterialSpread const uncertain = bracket("steel", steel, 0.25, 4);
  CouplingClass other = other_row(1e-20, {0}, 3);
  other.records = {record(0, 9.8e-21, {}), record(1, 1e-22, {phase_sensitivity(0, 2, two_k)}),
                   record(2, 1e-22, {phase_sensitivity(0, 2, two_k)})};
  EXPECT_TRUE(std::isnan(banded(table_of({other}), moving({linear_motion()}), {uncertain}).bands.input_high[0]));
  for (int const n : {0, 1, 2}) {
    other.members.push_back({by_steel(1, n, 1).steps});
    other.records[std::size_t(n)].member = std::uint32_t(n);
  }
  NoiseBudget const b = banded(table_of({other}), moving({linear_motion()}), {uncertain});
  EXPECT_NEAR(high(b), std::sqrt((4 + 16) / 2.0), 1e-6);
  EXPECT_NEAR(b.routes[0].input_low[0] / b.routes[0].asd[0], std::sqrt((0.25 + 0.0625) / 2), 1e-6);
  EXPECT_NEAR(b.bands.sources.at(0).share, 1, 1e-9);
  other.members[2].steps.clear();  // half of the noise is of a route without a name
  EXPECT_TRUE(std::isnan(banded(table_of({other}), moving({linear_motion()}), {uncertain}).routes[0].input_high[0]));
}

TEST(InputBand, LinearMotionScalesTheNoiseWrappedDoesNot) {
  CouplingTable const table = table_of({by_steel(1, 1, 1e-20)});
  MotionSet motion = moving({linear_motion()});
  motion.inputs[0].uncertainty = 1.4;
  NoiseBudget const linear = banded(table, motion, {});
  EXPECT_LT(deviation(high(linear), 1.4), 1e-3);
  EXPECT_LT(deviation(low(linear), 1 / 1.4), 1e-3);
  EXPECT_LT(deviation(linear.routes[0].input_low[0], linear.bands.input_low[0]), 1e-12);
  // Strong slow motion, eq. 7.8: sigma_f = 2 v_rms / lambda far above 10 Hz, so S ~ 1 / v_rms: more motion, less noise.
  MotionSet wrapped = moving({gaussian_line(0.35, 0.05, 1e-5)});
  wrapped.inputs[0].uncertainty = 1.4;
  NoiseBudget const w = banded(table, wrapped, {});
  EXPECT_LT(deviation(high(w), std::sqrt(1.4)), 0.05);
  EXPECT_LT(deviation(low(w), 1 / std::sqrt(1.4)), 0.05);
}

}  // namespace
}  // namespace straytrace::testing::noise_input_band
