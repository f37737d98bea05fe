// SPDX-License-Identifier: BSD-3-Clause
// Fits of synthetic fringe noise over many trials: what the errors and the outcome promise (requirements R6.07,
// docs/theory/fit.md).
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "analysis/fringes/fringe_fit.hpp"
#include "physics/analysis/fringe_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::commission_fringe_trials {
namespace {

using namespace straytrace::testing;

constexpr double rate = 512, seconds = 10;

TimeSeries noise(std::uint64_t seed) {
  return {"h", "1", 1e9, rate, detector_noise(seed, std::size_t(rate * seconds), rate, 1e-22, 40)};
}

FringeFitSettings settings() {
  FringeFitSettings s;
  s.low = 20;
  s.high = 85;
  s.paths = {{"path", {0.95, 1.05}, {}, {}, {}, {}}};
  return s;
}

struct Share {
  int one = 0, two = 0;
  void add(double pull) {
    one += std::fabs(pull) < 1;
    two += std::fabs(pull) < 2;
  }
};

double pull(Fitted const& f, double truth) { return (f.value - truth) / f.sigma; }

// All parameters free at once, two bodies: the errors are those of the whole covariance.
TEST(FringeTrials, ErrorsOfDelayRatioAndScaleCoverTheTrueValueR6_07) {
  std::vector<Sine> const one{{5e-6, 1.14, 0.3}}, two{{2e-6, 0.83, 1}};
  double const delay = 0.004, ratio = 0.6;
  int const trials = 200;
  std::map<std::string, Share> shares;
  int alone = 0;
  for (int i = 0; i < trials; ++i) {
    TimeSeries h = noise(5000 + std::uint64_t(i));
    add_fringes(h, {one[0], {-ratio * two[0].metres, two[0].hz, two[0].phase}}, 1e-21, 0.7 * i, 1, delay);
    FringeFitSettings s = settings();
    s.train = 0.5;
    s.paths[0].delay = {0.001, 0.007};
    s.ratio = {0.58, 0.62};
    FringeFit const fit = fit_fringes({h, {sine_motion(one, 128, seconds), sine_motion(two, 128, seconds)}}, s);
    FittedPath const& p = fit.paths[0];
    shares["amplitude"].add(pull(p.amplitude, 1e-21));
    shares["multiplicity"].add(pull(p.multiplicity, 1));
    shares["delay"].add(pull(p.delay, delay));
    shares["ratio"].add(pull(fit.ratio, ratio));
    shares["scale"].add(pull(fit.test.scale, 1));
    double const square = fit.test.ln_odds_expected.sigma / fit.test.scale.sigma;  // <m, m>
    alone += std::fabs(fit.test.scale.value - 1) * std::sqrt(square) < 1;
  }
  for (auto const& [name, share] : shares) {
    EXPECT_NEAR(share.one, 0.683 * trials, 3.5 * std::sqrt(0.683 * 0.317 * trials)) << name;
    EXPECT_GE(share.two, 0.954 * trials - 3.5 * std::sqrt(0.954 * 0.046 * trials)) << name;
  }
  EXPECT_LT(alone, 0.6 * trials) << "control: the factor's error without those of the fit";
}

// Strong enough, a fringe is found; too weak for the rest to decide, it is untested and not refuted.
TEST(FringeTrials, OutcomeFollowsTheStrengthR6_07) {
  std::vector<Sine> const baffle{{5.2e-6, 1.14, 0.3}};
  int const trials = 60;
  auto const verdicts = [&](double gain) {
    std::map<FitOutcome, int> seen;
    for (int i = 0; i < trials; ++i) {
      TimeSeries h = noise(7000 + std::uint64_t(i));
      add_fringes(h, baffle, gain, 0.7 * i, 1);
      FringeFitSettings s = settings();
      s.paths[0].multiplicity = {0.8, 1.25};
      ++seen[fit_fringes({h, {sine_motion(baffle, 128, seconds)}}, s).verdict];
    }
    return seen;
  };
  auto strong = verdicts(1.2e-21), weak = verdicts(2.5e-22);  // expected odds of the rest: e^90 and e^4
  EXPECT_EQ(strong[FitOutcome::found], trials);
  EXPECT_EQ(weak[FitOutcome::not_general], 0) << "the model is right";
  EXPECT_GE(weak[FitOutcome::untested], trials / 2);
}

}  // namespace
}  // namespace straytrace::commission_fringe_trials
