// SPDX-License-Identifier: BSD-3-Clause
// Fits to photodiodes with mirrors whose heights are not known, over draws (docs/theory/wave.md, eq. W.43, W.44).
#include <gtest/gtest.h>

#include <cmath>

#include "physics/wave/end_baffle.hpp"
#include "support/recorded.hpp"

namespace straytrace::nightly_wave_diodes {
namespace {

using namespace testing::end_baffle;
using testing::deviation;

// The error of the tilt is that of its scatter over draws: pulls have a mean square of 1, which 20 draws know to a
// third.
TEST(DiodesOverDraws, PullsHaveTheirWidth) {
  int const draws = 20;
  double pulls = 0, chi2 = 0, without = 0;
  HaloStatistics const h = halo({});
  for (int seed = 1; seed <= draws; ++seed) {
    Truth truth;
    truth.tilt2_x = 0.3e-6;
    truth.seed = std::uint64_t(seed);
    Eigen::VectorXd const clean = watts(truth), error = 0.02 * clean;
    DiodeFitProblem problem = problem_of({{-1, 1}}, measured(clean, error, truth.seed), error, tilted);
    problem.mean = [&](Eigen::VectorXd const& at) -> Eigen::VectorXd { return watts(tilted(at)) + 1e4 * h.mean; };
    without += fit_diodes(problem).chi2 / draws;
    problem.covariance = [&](Eigen::VectorXd const& at) -> Eigen::MatrixXd {
      return 1e8 * halo(tilted(at)).covariance;
    };
    DiodeFit const fit = fit_diodes(problem);
    pulls += std::pow((fit.parameters[0].value - 0.3) / fit.parameters[0].sigma, 2) / draws;
    chi2 += fit.chi2 / fit.degrees / draws;
  }
  EXPECT_LT(deviation(pulls, 1), 1);
  EXPECT_LT(deviation(chi2, 1), 0.3);
  EXPECT_GT(without, 2 * 23);  // negative control: speckle left out of the errors
}

}  // namespace
}  // namespace straytrace::nightly_wave_diodes
