// SPDX-License-Identifier: BSD-3-Clause
// Tilts and defects of mirrors from the power on photodiodes (docs/theory/wave.md, eq. W.44): synthetic truth is
// recovered within its errors, and a wrong model is rejected.
#include "wave/diodes/diode_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "physics/wave/end_baffle.hpp"
#include "support/recorded.hpp"

namespace straytrace::wave_diode_fit {
namespace {

using namespace testing::end_baffle;

// To powers of known mirrors with an error of 2 %.
DiodeFit fit_of(Truth const& truth, std::uint64_t seed, std::vector<FitRange> ranges,
                std::function<Truth(Eigen::VectorXd const&)> const& model) {
  Eigen::VectorXd const clean = watts(truth), error = 0.02 * clean;
  return fit_diodes(problem_of(std::move(ranges), measured(clean, error, seed), error, model));
}

TEST(DiodeFit, TiltAndBumpOfKnownMirrors) {
  Truth truth;
  truth.tilt2_x = 0.3e-6;
  truth.bump = 1e-9;
  truth.bump_x = 5e-3;
  DiodeFit const fit = fit_of(truth, 1, {{-1, 1}, {0, 3}}, [](Eigen::VectorXd const& at) {
    Truth t = tilted(at);
    t.bump = 1e-9 * at[1];
    t.bump_x = 5e-3;
    return t;
  });
  EXPECT_LT(std::fabs(fit.parameters[0].value - 0.3), 3 * fit.parameters[0].sigma);
  EXPECT_LT(std::fabs(fit.parameters[1].value - 1), 3 * fit.parameters[1].sigma);
  EXPECT_LT(fit.parameters[0].sigma, 0.1);
  EXPECT_LT(fit.parameters[1].sigma, 0.1);
  EXPECT_GT(fit.probability, 0.01);
  // Negative control: the same data without the bump in the model.
  DiodeFit const wrong = fit_of(truth, 1, {{-1, 1}}, tilted);
  EXPECT_LT(wrong.probability, 1e-6);
}

// Diodes in one plane see where the beam is, not its direction: of two tilts they determine one combination,
// x_2 = L (alpha_1 + g_1 alpha_2)/(1 - g_1 g_2) (eq. W.23).
TEST(DiodeFit, TellsTheCombinationThatIsNotDetermined) {
  Truth truth;
  truth.tilt2_x = 0.2e-6;
  DiodeFit const fit = fit_of(truth, 2, {{-0.5, 0.5}, {-0.5, 0.5}}, [](Eigen::VectorXd const& at) {
    Truth t;
    t.tilt1_x = 1e-6 * at[0];
    t.tilt2_x = 1e-6 * at[1];
    return t;
  });
  ASSERT_EQ(fit.undetermined.size(), 1u);
  EXPECT_NEAR(fit.undetermined[0][0] / fit.undetermined[0][1], -0.6, 0.1);  // -g_1
  EXPECT_FALSE(fit.parameters[0].determined || fit.parameters[1].determined);
  EXPECT_GT(fit.probability, 0.01);
}

// Heights of the mirrors that are not known: their speckle is part of the error, here 5 % on a photodiode of the inner
// ring from interference with the tail of the beam.
TEST(DiodeFit, SpeckleIsPartOfTheError) {
  Truth truth;
  truth.tilt2_x = 0.3e-6;
  truth.seed = 3;
  Eigen::VectorXd const clean = watts(truth), error = 0.002 * clean;
  HaloStatistics const h = halo({});
  DiodeFitProblem problem = problem_of({{-1, 1}}, measured(clean, error, 3), error, tilted);
  problem.mean = [&](Eigen::VectorXd const& at) -> Eigen::VectorXd { return watts(tilted(at)) + 1e4 * h.mean; };
  DiodeFit const without = fit_diodes(problem);  // negative control
  EXPECT_LT(without.probability, 1e-6);
  problem.covariance = [&](Eigen::VectorXd const&) -> Eigen::MatrixXd { return 1e8 * h.covariance; };
  DiodeFit const fit = fit_diodes(problem);
  EXPECT_LT(std::fabs(fit.parameters[0].value - 0.3), 3 * fit.parameters[0].sigma);
  EXPECT_GT(fit.parameters[0].sigma, 5 * without.parameters[0].sigma);
  EXPECT_LT(fit.parameters[0].sigma, 0.2);
  EXPECT_GT(fit.probability, 0.01);
  EXPECT_LT(fit.effective_degrees, fit.degrees);
}

}  // namespace
}  // namespace straytrace::wave_diode_fit
