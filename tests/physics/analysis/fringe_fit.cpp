// SPDX-License-Identifier: BSD-3-Clause
// Fits of synthetic fringe noise find what was put in (requirements R6.06, R6.07).
#include "analysis/fringes/fringe_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "physics/analysis/fringe_support.hpp"
#include "spectra/welch.hpp"
#include "support/recorded.hpp"

namespace straytrace::commission_fringe_fit {
namespace {

using namespace straytrace::testing;

constexpr double rate = 512, seconds = 20;
// The swinging baffle of B3: bump at 4 pi A f/lambda = 70 Hz.
std::vector<Sine> const baffle{{5.2e-6, 1.14, 0.3}};

TimeSeries quiet(std::uint64_t seed, double floor = 3e-23, double length = seconds) {
  return {"h", "1", 1e9, rate, detector_noise(seed, std::size_t(rate * length), rate, floor, 40)};
}

FringeFitSettings around(double low, double high) {
  FringeFitSettings s;
  s.low = 20;
  s.high = 85;
  s.paths = {{"path", {low, high}, {}, {}, {}, {}}};
  return s;
}

// The fit states phases at the mean of the witness.
double phase_at_mean(FringeFit const& fit, double phase, double multiplicity) {
  return std::remainder(phase + 4 * pi * multiplicity * fit.means[0] / 1064e-9, 2 * pi);
}

double pull(Fitted const& f, double truth) { return (f.value - truth) / f.sigma; }

// R6.07: G 2e-21, A 5.2 um at 1.14 Hz; the witness reads 4 um, so that the effective factor is 1.3.
TEST(FringeFit, SwingingBaffleR6_07) {
  TimeSeries h = quiet(1);
  add_fringes(h, baffle, 2e-21, 1.1, 1);
  FringeRecords const records{h, {sine_motion({{4e-6, 1.14, 0.3}}, 128, seconds)}};
  FringeFit const fit = fit_fringes(records, around(0.5, 3));
  FittedPath const& p = fit.paths[0];
  EXPECT_EQ(fit.verdict, FitOutcome::found);
  EXPECT_NEAR(p.amplitude.value, 2e-21, 0.02 * 2e-21);
  EXPECT_NEAR(p.multiplicity.value * 4e-6, 5.2e-6, 0.02 * 5.2e-6);
  EXPECT_LT(p.amplitude.sigma, 0.01 * 2e-21);
  EXPECT_LT(std::fabs(pull(p.phase, phase_at_mean(fit, 1.1, 1.3))), 4);
  EXPECT_NEAR(fit.highest_fringe, 70, 0.02 * 70);  // eq. 7.2
  EXPECT_NEAR(fit.test.scale.value, 1, 4 * fit.test.scale.sigma);
  EXPECT_NEAR(fit.with / fit.degrees, 1, 0.1);
}

// The maximum of the likelihood lies beyond the range: 1.2 removes much of the power of 1.3, but does not fit.
TEST(FringeFit, AMaximumAtTheEndOfTheRangeIsNotFound) {
  TimeSeries h = quiet(1);
  add_fringes(h, baffle, 2e-21, 1.1, 1);
  FringeRecords const records{h, {sine_motion({{4e-6, 1.14, 0.3}}, 128, seconds)}};
  for (auto const& [low, high] : {std::pair{0.5, 1.295}, std::pair{1.305, 3.0}}) {
    FringeFit const fit = fit_fringes(records, around(low, high));
    EXPECT_TRUE(fit.paths[0].multiplicity.at_end) << low;
    EXPECT_EQ(fit.verdict, FitOutcome::at_end) << low;
  }
}

// R6.07: 68 % of the errors within one stated standard error, at least 95 % within two; both methods.
void expect_coverage(FitMethod method, int trials) {
  std::vector<int> one(4), two(4);
  for (int i = 0; i < trials; ++i) {
    TimeSeries h = quiet(100 + std::uint64_t(i), 1e-22, 10);
    double const phase = 0.7 * i, drift = 0.2;
    add_fringes(h, baffle, 2e-21, phase, 1, 0, drift);
    FringeFitSettings s = around(0.95, 1.05);
    s.train = 1;
    s.method = method;
    s.paths[0].drift = {0, 0.6};
    FringeFit const fit = fit_fringes({h, {sine_motion(baffle, rate, 10)}}, s);
    FittedPath const& p = fit.paths[0];
    double const at_middle = phase_at_mean(fit, phase + drift * (fit.middle - 1e9), 1);
    Fitted turned = p.phase;
    turned.value = std::remainder(p.phase.value - at_middle, 2 * pi);
    double const pulls[] = {pull(p.amplitude, 2e-21), pull(turned, 0), pull(p.multiplicity, 1), pull(p.drift, drift)};
    for (std::size_t k = 0; k < 4; ++k) {
      one[k] += std::fabs(pulls[k]) < 1;
      two[k] += std::fabs(pulls[k]) < 2;
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    // Binomial spread of a right error; a third too small or too large falls out.
    EXPECT_NEAR(one[k], 0.683 * trials, 3.5 * std::sqrt(0.683 * 0.317 * trials)) << "parameter " << k;
    EXPECT_GE(two[k], 0.954 * trials - 3.5 * std::sqrt(0.954 * 0.046 * trials)) << "parameter " << k;
  }
}

TEST(FringeFit, ErrorsCoverTheTrueValueR6_07) { expect_coverage(FitMethod::frequency, 100); }
TEST(FringeFit, ErrorsCoverTheTrueValueInTheTimeDomainR6_07) { expect_coverage(FitMethod::time, 100); }

// Two ways to weigh the same data.
TEST(FringeFit, TimeDomainAgreesWithFrequencyDomainR6_07) {
  TimeSeries h = quiet(7, 1e-22);
  add_fringes(h, baffle, 2e-21, 2, 1, 0.004);
  FringeRecords const records{h, {sine_motion(baffle, rate, seconds)}};
  FringeFitSettings s = around(0.8, 1.2);
  s.paths[0].delay = {-0.02, 0.02};
  FringeFit const lines = fit_fringes(records, s);
  s.method = FitMethod::time;
  FringeFit const samples = fit_fringes(records, s);
  auto const agree = [](Fitted const& a, Fitted const& b) {
    EXPECT_NEAR(a.value, b.value, a.sigma);  // their noise is nearly the same
    EXPECT_NEAR(a.sigma / b.sigma, 1, 0.1);
  };
  agree(lines.paths[0].amplitude, samples.paths[0].amplitude);
  agree(lines.paths[0].multiplicity, samples.paths[0].multiplicity);
  agree(lines.paths[0].delay, samples.paths[0].delay);
  EXPECT_NEAR(lines.paths[0].delay.value, 0.004, 4 * lines.paths[0].delay.sigma);
  EXPECT_NEAR(samples.with / samples.degrees, 1, 0.1);
}

// A witness that has nothing to do with it: false alarms as often as stated, 1e-3 here 0.05 so that they can be
// counted.
TEST(FringeFit, WrongWitnessGivesNoFringe) {
  int alarms = 0, found = 0, odds = 0, halves = 0;
  int const trials = 200;
  for (int i = 0; i < trials; ++i) {
    FringeFitSettings s = around(0.5, 2);
    s.false_alarm = 0.05;
    FringeFit const fit =
        fit_fringes({quiet(1000 + std::uint64_t(i), 1e-22, 10), {sine_motion({{3e-6, 0.7, 0.1 * i}}, 64, 10)}}, s);
    alarms += fit.verdict != FitOutcome::none;
    found += fit.verdict == FitOutcome::found;
    odds += fit.test.ln_odds >= -std::log(0.05);
    halves += fit.test.scale.value > 0.5;
  }
  EXPECT_LE(alarms, 0.05 * trials + 3.5 * std::sqrt(0.05 * 0.95 * trials));
  EXPECT_GE(alarms, 1) << "so few that the look-elsewhere correction must be too large";
  EXPECT_LE(found, 3) << "0.05^2: the rest is noise of its own";
  EXPECT_LE(odds, 0.05 * trials) << "Markov: a bound, not a mean";
  EXPECT_GT(halves, 0.05 * trials) << "control: half of the model occurs in noise more often";
}

// Negative controls: the linear model of R2.37 (multiplicity so small that fringes do not wrap) and a wrong
// multiplicity find nothing in strong fringes.
TEST(FringeFit, WrongModelsAreRejected) {
  TimeSeries h = quiet(3);
  add_fringes(h, baffle, 2e-21, 0.4, 1);
  FringeRecords const records{h, {sine_motion(baffle, 128, seconds)}};
  EXPECT_EQ(fit_fringes(records, around(1, 1)).verdict, FitOutcome::found);
  EXPECT_EQ(fit_fringes(records, around(1e-3, 1e-3)).verdict, FitOutcome::none);
  EXPECT_EQ(fit_fringes(records, around(2, 2)).verdict, FitOutcome::none);
}

// The static phase drifts in the second part only: what was fitted no longer holds.
TEST(FringeFit, AFitThatFailsOnTheRestDoesNotGeneralise) {
  TimeSeries h = quiet(5);
  TimeSeries late = h;
  add_fringes(h, baffle, 2e-21, 0.4, 1);
  add_fringes(late, baffle, 2e-21, 0.4 + pi, 1);
  std::copy(late.samples.begin() + std::ptrdiff_t(0.7 * seconds * rate), late.samples.end(),
            h.samples.begin() + std::ptrdiff_t(0.7 * seconds * rate));
  FringeFit const fit = fit_fringes({h, {sine_motion(baffle, 128, seconds)}}, around(0.9, 1.1));
  EXPECT_EQ(fit.verdict, FitOutcome::not_general);
  EXPECT_LT(fit.test.scale.value, 0);
}

// R6.06, R6.07: two paths of different bounce number, drifting static phase and delay; two bodies with a free ratio.
TEST(FringeFit, TwoPathsR6_07) {
  TimeSeries h = quiet(11);
  std::vector<Sine> const slow{{3e-6, 0.9, 0.2}, {0.5e-6, 0.37, 1}};
  add_fringes(h, slow, 2e-21, 1, 1);
  add_fringes(h, slow, 8e-22, -2, 2, 0, 0.3);
  FringeFitSettings s = around(0.7, 2.5);
  s.paths.push_back(s.paths[0]);
  for (FringePath& p : s.paths) p.drift = {-0.5, 0.5};
  FringeFit const fit = fit_fringes({h, {sine_motion(slow, 64, seconds)}}, s);
  ASSERT_EQ(fit.verdict, FitOutcome::found);
  // The one that explains more of the band comes first: here the faster.
  FittedPath const &two = fit.paths[0], &one = fit.paths[1];
  EXPECT_NEAR(one.amplitude.value, 2e-21, 4 * one.amplitude.sigma);
  EXPECT_NEAR(one.multiplicity.value, 1, 4 * one.multiplicity.sigma);
  EXPECT_NEAR(one.drift.value, 0, 4 * one.drift.sigma);
  EXPECT_NEAR(two.amplitude.value, 8e-22, 4 * two.amplitude.sigma);
  EXPECT_NEAR(two.multiplicity.value, 2, 4 * two.multiplicity.sigma);
  EXPECT_NEAR(two.drift.value, 0.3, 4 * two.drift.sigma);
  EXPECT_LT(one.ln_false_alarm, -20);
  EXPECT_LT(two.ln_false_alarm, -20);
}

TEST(FringeFit, DifferentialMotionOfTwoBodies) {
  TimeSeries h = quiet(12);
  std::vector<Sine> const one{{4e-6, 0.8, 0.2}}, two{{3e-6, 0.55, 1}};
  add_fringes(h, {one[0], {-0.6 * 3e-6, 0.55, 1}}, 2e-21, 1, 1);
  FringeFitSettings s = around(0.8, 1.2);
  s.ratio = {0.3, 0.9};
  FringeFit const fit = fit_fringes({h, {sine_motion(one, 64, seconds), sine_motion(two, 64, seconds)}}, s);
  EXPECT_EQ(fit.verdict, FitOutcome::found);
  EXPECT_NEAR(fit.ratio.value, 0.6, 4 * fit.ratio.sigma);
  EXPECT_LT(fit.ratio.sigma, 0.01);
  EXPECT_NEAR(fit.paths[0].multiplicity.value, 1, 4 * fit.paths[0].multiplicity.sigma);
}

// R6.06: both quadratures, with responses of their own; the recoupled fraction comes back.
TEST(FringeFit, BothQuadraturesR6_06) {
  auto const phase = [](double) { return std::complex<double>(1.1e-16, 0); };
  auto const amplitude = [](double hz) { return 3e-16 * std::pow(30 / hz, 2) * std::complex<double>(0, 1); };
  FringeFitSettings s = around(0.9, 1.1);
  s.paths[0].phase = phase;
  s.paths[0].amplitude = amplitude;
  FringeRecords records{quiet(13), {sine_motion(baffle, 128, seconds)}};
  FringeFit truth;
  truth.paths = {{"path", {2e-5}, {0.5}, {1}, {}, {}, 0, 0}};
  truth.means = {0};
  truth.middle = 1e9;
  FringeModel const noise = fringe_model(records, s, truth);
  for (std::size_t i = 0; i < noise.values.size(); ++i) records.target.samples[noise.first + i] += noise.values[i];
  s.low = 25, s.high = 80;  // clear of the edges of the model's band
  FringeFit const fit = fit_fringes(records, s);
  EXPECT_EQ(fit.verdict, FitOutcome::found);
  EXPECT_NEAR(fit.paths[0].amplitude.value, 2e-5, 4 * fit.paths[0].amplitude.sigma);
  EXPECT_LT(fit.paths[0].amplitude.sigma, 0.02 * 2e-5);
  EXPECT_LT(std::fabs(pull(fit.paths[0].phase, phase_at_mean(fit, 0.5, 1))), 4);
  // Negative control: phase quadrature alone.
  s.paths[0].amplitude = {};
  FringeFit const control = fit_fringes(records, s);
  EXPECT_LT(control.paths[0].gain, 0.7 * fit.paths[0].gain);
}

// The subtracted series is the injected one: Welch spectra of the rest are at the noise level again, clear of the
// band's edges.
TEST(FringeFit, SubtractionLeavesTheNoise) {
  TimeSeries h = quiet(14);
  std::vector<double> const noise = h.samples;
  add_fringes(h, baffle, 2e-21, 1, 1, 0.003);
  FringeFitSettings s = around(0.9, 1.1);
  s.paths[0].delay = {-0.01, 0.01};
  FringeRecords const records{h, {sine_motion(baffle, 256, seconds)}};
  FringeModel const model = fringe_model(records, s, fit_fringes(records, s));
  std::vector<double> rest, before, alone;
  for (std::size_t i = 0; i < model.values.size(); ++i) {
    before.push_back(h.samples[model.first + i]);
    rest.push_back(before.back() - model.values[i]);
    alone.push_back(noise[model.first + i]);
  }
  auto const power = [&](std::vector<double> const& x) {
    WelchSpectrum const w = welch(x, rate, {1024});
    double sum = 0;
    for (std::size_t k = 0; k < w.hz.size(); ++k)
      if (w.hz[k] > 27 && w.hz[k] < 75) sum += w.psd[k];
    return sum;
  };
  EXPECT_GT(power(before), 10 * power(alone));
  EXPECT_NEAR(power(rest) / power(alone), 1, 0.05);
}

// The chance of a maximum: with no range it is that of chi^2 with two degrees of freedom.
TEST(FringeFit, ChanceOfAMaximum) {
  EXPECT_NEAR(std::exp(ln_chance_of(2 * std::log(1000), {})), 1e-3, 1e-6);
  EXPECT_GT(ln_chance_of(30, {100}), ln_chance_of(30, {10}));
  EXPECT_NEAR(std::exp(ln_chance_of(40, {50})), std::exp(-20) * (1 + 50 * std::sqrt(40 / (2 * pi))), 1e-9);
}

}  // namespace
}  // namespace straytrace::commission_fringe_fit
