// SPDX-License-Identifier: BSD-3-Clause
// Several bodies on one path (docs/theory/spectra.md, eq. 1.10, 2.5, 7.12).
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

// Light from body 0 to body 1 and back: +2k on one, -2k on the other.
double level(MotionSet const& motion) {
  CouplingTable const table = known_table(
      {known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, -two_k)})})});
  return project_noise(table, motion, UnitDetector(), on({10, 10.4})).total.asd[0];
}

TEST(SeveralBodies, OnlyRelativeMotionCounts) {
  Spectrum const s = power_law_asd(1e-13, 10, -2, 1, 100);
  MotionSet together = moving({s});
  together.inputs[0].gains.push_back({BodyId{1}, 2, 1});
  EXPECT_EQ(level(together), 0);
  double const alone = std::sqrt(two_k * two_k * s.power(10, 10.4) / 0.4 / 2);
  double const apart = level(moving({s, s}));
  EXPECT_LT(deviation(apart, std::sqrt(2) * alone), 1e-4);  // control of the first: independent bodies do not cancel
  MotionSet opposite = moving({s});
  opposite.inputs[0].gains.push_back({BodyId{1}, 2, -1});
  EXPECT_LT(deviation(level(opposite), 2 * alone), 1e-4);
  EXPECT_GT(deviation(level(opposite), apart), 0.1);  // control: powers added where amplitudes must be
}

TEST(SeveralBodies, TonesAddWithTheirPhases) {  // eq. 7.2: z = |sum J A exp(ip)|; tolerance 1e-9
  MotionSet set;
  set.inputs.push_back({"tone", {}, 1, {{BodyId{0}, 2, 3e-7}, {BodyId{1}, 2, std::polar(4e-7, pi / 2)}}});
  std::vector<PhaseSensitivity> const phase_sensitivities = {phase_sensitivity(0, 2, two_k),
                                                             phase_sensitivity(1, 2, two_k)};
  EXPECT_LT(deviation(std::sqrt(set.sensitivity(0, phase_sensitivities, 1)), two_k * 5e-7), 1e-9);
  EXPECT_GT(deviation(std::sqrt(set.sensitivity(0, phase_sensitivities, 1)), two_k * 7e-7),
            0.1);  // control: phases forgotten
}

TEST(SeveralBodies, ShapesAreGrouped) {
  Spectrum const s = power_law_asd(1e-9, 1, -2, 0.1, 100);
  MotionSet const set = moving({s, s.scaled(0.49), power_law_asd(1e-9, 1, -2.1, 0.1, 100), s.scaled(3)});
  std::vector<MotionClass> const classes = group_by_shape(set);
  ASSERT_EQ(classes.size(), 2u);
  EXPECT_EQ(classes[0].members.size(), 3u);
  std::vector<PhaseSensitivity> const phase_sensitivities = {phase_sensitivity(0, 2, 2), phase_sensitivity(1, 2, 3),
                                                             phase_sensitivity(2, 2, 5)};
  std::vector<double> const kappa = kappa_of(set, classes, phase_sensitivities);
  EXPECT_NEAR(kappa[0], 4 + 9 * 0.49, 1e-9);
  EXPECT_NEAR(kappa[1], 25, 1e-9);
}

}  // namespace
}  // namespace straytrace::testing
