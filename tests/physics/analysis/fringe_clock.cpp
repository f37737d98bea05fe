// SPDX-License-Identifier: BSD-3-Clause
// A fit of fringes does not trust the clock of the witness (docs/theory/fit.md, clocks).
#include <gtest/gtest.h>

#include <cmath>

#include "physics/analysis/fringe_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::commission_fringe_clock {
namespace {

using namespace straytrace::testing;

constexpr double rate = 256, seconds = 64, gain = 4e-22;
std::vector<Sine> const sway{{4.6e-6, 1.14, 0.3}, {1.2e-6, 0.31, 1}};

// Noise that comes `late` seconds behind the witness.
FringeFit fitted(std::uint64_t seed, double late, double clock) {
  TimeSeries h{"h", "1", 1e9, rate, detector_noise(seed, std::size_t(rate * seconds), rate, 3e-23, 20)};
  add_fringes(h, sway, gain, 0.3, 1, late);
  FringeFitSettings s;
  s.low = 20;
  s.high = 85;
  s.paths.push_back({"path 1", {0.5, 1.5}, {}, {}, {}, {}});
  s.clock = clock;
  return fit_fringes({h, {sine_motion(sway, 64, seconds)}}, s);
}

TEST(FringeClock, ACommonClockIsFoundAndNotQuestionedR6_07) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    FringeFit const fit = fitted(seed, 0, 0.25);
    EXPECT_EQ(fit.verdict, FitOutcome::found);
    EXPECT_FALSE(fit.clock.better) << fit.clock.gain;
    EXPECT_NEAR(fit.paths[0].amplitude.value, gain, 4 * fit.paths[0].amplitude.sigma);
  }
}

// A wrong clock is reported with its delay and the amplitude there; control: the fit that trusts it finds another
// amplitude.
TEST(FringeClock, AWrongClockIsReportedR6_07) {
  for (double const late : {0.031, -0.031, 0.2}) {
    FringeFit const fit = fitted(7, late, 0.25);
    EXPECT_EQ(fit.verdict, FitOutcome::clock) << late;
    EXPECT_TRUE(fit.clock.doubtful);
    EXPECT_NEAR(fit.clock.delay.value, late, 5 * fit.clock.delay.sigma);
    EXPECT_LT(fit.clock.delay.sigma, 2e-3);
    EXPECT_NEAR(fit.clock.paths[0].amplitude.value, gain, 4 * fit.clock.paths[0].amplitude.sigma);
    EXPECT_NEAR(fit.clock.paths[0].multiplicity.value, 1, 5 * fit.clock.paths[0].multiplicity.sigma);
    FringeFit const trusting = fitted(7, late, 0);
    Fitted const g = trusting.paths[0].amplitude;
    EXPECT_GT(std::fabs(g.value - gain), 4 * g.sigma) << "control: a clock that is trusted";
    EXPECT_NE(trusting.verdict, FitOutcome::clock);
  }
}

// The search stays within the given range.
TEST(FringeClock, ADelayBeyondTheRangeIsNotFound) {
  FringeFit const fit = fitted(7, 0.2, 0.05);
  EXPECT_TRUE(fit.verdict != FitOutcome::clock || fit.clock.delay.at_end);
}

}  // namespace
}  // namespace straytrace::commission_fringe_clock
