// SPDX-License-Identifier: BSD-3-Clause
// Significance of excess between averaged spectra (R6.01).
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_f.hpp>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "spectra/welch.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace {
namespace {

using namespace straytrace::testing;

TEST(Excess, ClosedFormsOfFAndChiSquareR6_01) {
  // F(2, 2): P(> r) = 1/(1 + r); chi-square with 2 degrees: exp(-r); scipy.stats.f.sf(4, 40, 40).
  EXPECT_NEAR(probability_of_sigmas(excess_significance({9, 1}, {1, 1})), 0.1, 1e-12);
  EXPECT_NEAR(probability_of_sigmas(excess_significance({9, 1}, {1, 1e9})), std::exp(-9), 1e-12);
  EXPECT_NEAR(probability_of_sigmas(excess_significance({4, 20}, {1, 20})), 1.335958173e-5, 1e-13);
  EXPECT_NEAR(excess_significance({9, 20}, {1, 20}), 6.356217, 1e-5);
  EXPECT_NEAR(excess_significance({3, 20}, {1, 1e9}), 6.071098, 1e-5);
  EXPECT_NEAR(excess_significance({3, 20}, {1, 20}), 3.371616, 1e-5);
  EXPECT_NEAR(probability_of_sigmas(3), 1.3498980e-3, 1e-10);
  EXPECT_NEAR(sigmas_of_probability(1.3498980e-3), 3, 1e-7);
  EXPECT_NEAR(excess_significance({0.2, 12}, {1, 12}), -excess_significance({1, 12}, {0.2, 12}), 1e-9);
  EXPECT_EQ(excess_significance({1e9, 1000}, {1, 1000}), largest_significance);
  EXPECT_TRUE(std::isnan(excess_significance({0, 10}, {1, 10})));
  EXPECT_NEAR(upper_factor(1, 0.95), 1 / -std::log(0.95), 1e-9);  // 2 / quantile of exp(-x/2) at 5 %
}

// Probability that a line in noise, `line` times its PSD, is found at 5 sigma: the ratio of PSDs follows a
// non-central F distribution.
double chance_of_line(double line, double loud, double quiet) {
  double const limit = quantile(complement(boost::math::fisher_f(2 * loud, 2 * quiet), probability_of_sigmas(5)));
  return cdf(complement(boost::math::non_central_f(2 * loud, 2 * quiet, 2 * loud * line), limit));
}

// `found` of `trials` lies within four standard deviations of a binomial distribution.
void expect_share(int found, int trials, double chance) {
  EXPECT_NEAR(found, trials * chance, 4 * std::sqrt(trials * chance * (1 - chance)) + 1);
}

// 20 averages in the injection, as Welch makes them of white noise with a line of unknown phase in one bin.
TEST(Excess, ThreefoldInOneBinIsFoundAtFiveSigmaR6_01) {
  constexpr std::size_t n = 128, stretch = 11 * n;
  constexpr double fs = 128, noise = 2 / fs, bandwidth = 1.5 * fs / n;
  constexpr int trials = 200;
  constexpr WelchSettings settings{.segment = n};
  int by_amplitude = 0, by_power = 0, false_alarms = 0;
  for (int i = 0; i < trials; ++i) {
    auto const seed = 4 * std::uint64_t(i);
    double const phase = white_noise(1, seed)[0] * 10;
    std::vector<double> const own = white_noise(stretch, seed + 1);
    WelchSpectrum const quiet = welch(white_noise(stretch, seed + 2), fs, settings);
    WelchSpectrum const known = welch(white_noise(20 * stretch, seed + 3), fs, settings);
    auto const with_line = [&](double psd) {  // a^2/(2 ENBW) = psd
      std::vector<double> y = own;
      for (std::size_t j = 0; j < y.size(); ++j)
        y[j] += std::sqrt(2 * bandwidth * psd) * std::cos(2 * pi * 32 * double(j) / double(n) + phase);
      return welch(y, fs, settings);
    };
    auto const averages = [](WelchSpectrum const& s) { return std::pow(s.psd[32] / s.sigma[32], 2); };
    auto const sure = [&](WelchSpectrum const& loud, WelchSpectrum const& still, std::size_t bin) {
      return excess_significance({loud.psd[bin], averages(loud)}, {still.psd[bin], averages(still)});
    };
    EXPECT_NEAR(averages(quiet), 20, 1);
    WelchSpectrum const loud = with_line(8 * noise);
    by_amplitude += sure(loud, quiet, 32) > 5;              // 3 x in ASD, quiet stretch as short
    by_power += sure(with_line(2 * noise), known, 32) > 5;  // 3 x in PSD, quiet level known
    for (std::size_t k = 40; k < 60; k += 2) false_alarms += sure(loud, quiet, k) > 2;
  }
  EXPECT_GE(by_amplitude, 0.95 * trials);
  expect_share(by_amplitude, trials, chance_of_line(8, 20, 20));   // 0.99
  expect_share(by_power, trials, chance_of_line(2, 20, 20 * 20));  // 0.75
  EXPECT_NEAR(false_alarms / (10.0 * trials), 0.02275, 0.01);
  EXPECT_GT(std::fabs(excess_significance({3, 20}, {1, 20}) - (3 - 1) * std::sqrt(20)), 5) << "control: normal errors";
}

}  // namespace
}  // namespace straytrace
