// SPDX-License-Identifier: BSD-3-Clause
// Couplings that a table predicts (docs/theory/spectra.md, eq. 7.2, 7.9, 10.1; docs/theory/commissioning.md C.11).
#include "noise/project/sensor_noise.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_predicted_coupling {
namespace {

std::vector<std::string> const bodies{"tube", "bench"};
FrequencyGrid const grid = logarithmic_grid(10, 1000, 20);

// Two routes: one bounce off the tube with f = 1e-20, two bounces off the bench with f = 4e-20.
CouplingTable two_routes() {
  return known_table({known_class(1, 1e-20, {record(0, 1e-20, {phase_sensitivity(0, 2, two_k)})}),
                      known_class(2, 4e-20,
                                  {record(1, 2e-20, {phase_sensitivity(1, 2, 2 * two_k)}),
                                   record(2, 2e-20, {phase_sensitivity(1, 2, 2 * two_k)})})});
}

TEST(PredictedCoupling, SmallMotionIsTheLinearLimitEq7_9) {
  UnitDetector const ifo;
  PredictedCoupling const tube = predict_coupling(two_routes(), bodies, ifo, grid, {BodyId{0}, 2});
  PredictedCoupling const bench = predict_coupling(two_routes(), bodies, ifo, grid, {BodyId{1}, 2});
  for (std::size_t i = 0; i < grid.size(); ++i) {
    EXPECT_LT(deviation(tube.factor[i], std::sqrt(1e-20 / 2) * two_k), 1e-6);
    EXPECT_LT(deviation(bench.factor[i], std::sqrt(4e-20 / 2) * 2 * two_k), 1e-6);
    EXPECT_GT(deviation(tube.factor[i], std::sqrt(1e-20) * two_k), 0.2) << "control: without the mean over phases";
  }
  ASSERT_EQ(tube.routes.size(), 1u);
  EXPECT_NEAR(tube.routes[0].multiplicity, 1, 1e-6);
  EXPECT_NEAR(bench.routes[0].multiplicity, 2, 1e-6);
  EXPECT_NEAR(tube.linear_to, 84.67e-9, 5e-12);       // lambda/4 pi
  EXPECT_NEAR(bench.linear_to, 84.67e-9 / 2, 5e-12);  // over the multiplicity
  EXPECT_NEAR(tube.routes[0].share, 1, 1e-12);
  PredictedCoupling const none = predict_coupling(two_routes(), bodies, ifo, grid, {BodyId{0}, 0});
  EXPECT_TRUE(none.routes.empty());
}

TEST(PredictedCoupling, MonteCarloErrorIsThatOfTheTable) {
  CouplingTable table = two_routes();
  for (std::size_t r = 0; r < replica_count; ++r) table.classes[0].replica_sum[r] *= r % 2 ? 1.2 : 0.8;
  PredictedCoupling const p = predict_coupling(table, bodies, UnitDetector(), grid, {BodyId{0}, 2});
  // Replicas +- 20 %: error of the mean 20 %/sqrt(31) of the power, half of it in amplitude.
  for (std::size_t i = 0; i < grid.size(); i += 7)
    EXPECT_LT(deviation(p.sigma[i] / p.factor[i], 0.1 / std::sqrt(31)), 0.02);
}

TEST(PredictedCoupling, DrivenBodyHasLinesAndAShelfEq7_2) {
  double const peak = 2e-6, hz = 0.5, z = two_k * peak;
  FrequencyGrid fine;
  for (int i = 0; i <= 40; ++i) fine.edges.push_back(2.25 + 0.5 * i);  // one line in each bin
  DrivenResponse const d = drive_body(two_routes(), bodies, UnitDetector(), fine, {BodyId{0}, 2}, peak, hz);
  ASSERT_EQ(d.routes.size(), 1u);
  EXPECT_LT(deviation(d.routes[0].phase_peak, z), 1e-4);
  EXPECT_LT(deviation(d.routes[0].cutoff, z * hz), 1e-4);  // 11.8 Hz
  double inside = 0, outside = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    double const power = std::pow(d.budget.total.asd[i], 2) * fine.width(i);
    double const n = std::round(fine.centre(i) / hz), line = std::pow(std::cyl_bessel_j(n, z), 2) * 1e-20;  // eq. 7.4
    if (n < 30) {
      EXPECT_NEAR(power, line, 2e-3 * 1e-20);
    }
    (fine.centre(i) < 12.5 ? inside : outside) += power;
  }
  EXPECT_LT(outside, 0.05 * inside);
}

// A bound on rims that hardly moves, and a row `other` of still bright light with faint light from a moving surface,
// which carries most of the noise: 1e-29 (2k)^2 against 3e-17 (2.45 rad/m)^2.
CouplingTable bound_and_other() {
  CouplingClass edge = known_class(1, 3e-17, {record(0, 3e-17, {phase_sensitivity(0, 2, 2.45)})});
  edge.kind = ClassKind::edge;
  edge.steps = {{GroupId{0}, Event::emit}, {GroupId{0}, Event::couple}};
  CouplingClass other =
      known_class(2, 1e-15, {record(0, 1e-15, {}), record(1, 1e-29, {phase_sensitivity(0, 2, two_k)})});
  other.coupling.trusted = false;
  other.coupling.why_not = "only 2 effective scores";
  CouplingTable table = known_table({edge, other});
  table.groups = {"mirror"};
  return table;
}

TEST(PredictedCoupling, TheLimitIsThatOfTheLightThatCarriesTheNoise) {
  PredictedCoupling const p = predict_coupling(bound_and_other(), bodies, UnitDetector(), grid, {BodyId{0}, 2});
  ASSERT_EQ(p.routes.size(), 2u);
  EXPECT_TRUE(p.routes[0].upper_bound);
  EXPECT_FALSE(p.routes[1].resolved);
  EXPECT_LT(deviation(p.routes[1].phase, two_k), 1e-6);
  EXPECT_GT(p.routes[1].phase, 1e5 * std::sqrt(1e-14) * two_k) << "control: the mean over its coupling";
  EXPECT_LT(deviation(p.linear_to, 1 / two_k), 1e-6);
  EXPECT_GT(1 / p.routes[0].phase, 1e6 * p.linear_to) << "control: the limit of the first row";
  EXPECT_GT(p.bound_share.at(0), 0.05);
  EXPECT_EQ(p.unresolved.size(), 1u);
  DrivenResponse const d = drive_body(bound_and_other(), bodies, UnitDetector(), grid, {BodyId{0}, 2}, 1e-6, 20);
  ASSERT_EQ(d.routes.size(), 2u);
  EXPECT_LT(deviation(d.routes[1].phase_peak, two_k * 1e-6), 1e-3);
}

TEST(PredictedCoupling, FaintRoutesDoNotLimitIt) {  // two bounces, with 0.4 % of the power
  CouplingTable const table =
      known_table({known_class(1, 1e-20, {record(0, 1e-20, {phase_sensitivity(0, 2, two_k)})}),
                   known_class(2, 1e-23, {record(1, 1e-23, {phase_sensitivity(0, 2, 2 * two_k)})})});
  PredictedCoupling const p = predict_coupling(table, bodies, UnitDetector(), grid, {BodyId{0}, 2});
  ASSERT_EQ(p.routes.size(), 2u);
  EXPECT_LT(deviation(p.routes[1].phase, 2 * two_k), 1e-6);
  EXPECT_LT(deviation(p.linear_to, 1 / two_k), 1e-6);
}

TEST(PredictedCoupling, MotionOfOneCoordinateIsTakenAlone) {
  MotionSet motion = moving({power_law_asd(1e-8, 1, 0, 1, 2), power_law_asd(1e-9, 1, 0, 1, 2)});
  motion.inputs.push_back(tone(3, 1e-7));
  motion.inputs.push_back({"ground", power_law_asd(1e-8, 1, 0, 1, 2), 0, {{BodyId{0}, 2, 0.5}, {BodyId{1}, 2, 0.5}}});
  MotionSet const tube = motion_along(motion, {BodyId{0}, 2});
  EXPECT_EQ(tube.inputs.size(), 3u);
  for (MotionInput const& i : tube.inputs) EXPECT_EQ(i.gains.size(), 1u);
  EXPECT_LT(deviation(rms_of(motion, {BodyId{0}, 2}), std::sqrt(1e-16 + 0.25e-16 + 1e-14 / 2)), 1e-6);
}

}  // namespace
}  // namespace straytrace::testing::noise_predicted_coupling
