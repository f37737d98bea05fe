// SPDX-License-Identifier: BSD-3-Clause
// Coherence and transfer functions (R6.05).
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.hpp"
#include "spectra/welch.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::signal_cross_spectra {
namespace {

using testing::white_noise;
constexpr double rate = 256;

std::vector<double> sum(std::vector<double> a, std::vector<double> const& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

// Independent records: mean coherence 1/n, and 5 % of the lines above the 5 % level. Half overlap, so that counting
// segments instead of independent ones (the control) would expect fewer.
TEST(CrossSpectra, CoherenceOfIndependentNoise) {
  WelchSettings const settings{.segment = 512};
  double above = 0, above_control = 0, mean = 0, lines = 0, n = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    CrossSpectra const s = cross_spectra(white_noise(512 * 8, 2 * i), white_noise(512 * 8, 2 * i + 1), rate, settings);
    n = s.effective_averages;
    double const level = coherence_level(n), control = coherence_level(double(s.segments));
    std::vector<double> const c = coherence(s);
    for (std::size_t k = 4; k < 252; k += 4, ++lines) {
      mean += c[k];
      above += c[k] > level ? 1 : 0;
      above_control += c[k] > control ? 1 : 0;
    }
  }
  double const spread = std::sqrt(0.05 * 0.95 / lines);
  EXPECT_NEAR(mean / lines, 1 / n, 5 * (1 / n) / std::sqrt(lines));
  EXPECT_NEAR(above / lines, 0.05, 5 * spread);
  EXPECT_GT(above_control / lines, 0.05 - 5 * spread);
  EXPECT_EQ(coherence_level(1), 1);
}

// y = x + noise of equal power: coherence 1/2; the interval holds it in 95 % of the lines.
TEST(CrossSpectra, CoherenceIntervalCoversTheTrueValue) {
  double inside = 0, lines = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    std::vector<double> const x = white_noise(512 * 16, 3 * i + 1000), y = sum(x, white_noise(512 * 16, 3 * i + 1001));
    CrossSpectra const s = cross_spectra(x, y, rate, {.segment = 512});
    Interval const interval = coherence_interval(coherence(s), s.effective_averages);
    for (std::size_t k = 4; k < 252; k += 4, ++lines)
      inside += interval.low[k] <= 0.5 && 0.5 <= interval.high[k] ? 1 : 0;
  }
  EXPECT_NEAR(inside / lines, 0.95, 0.015);
}

// y = x + noise of equal power, H = 1: the circle around the estimate holds it in 95 % of the lines; control: half of
// it. It leaves zero out just where the coherence is above the level of chance.
TEST(CrossSpectra, ConfidenceCircleCoversTheTrueValue) {
  double inside = 0, half = 0, lines = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    std::vector<double> const x = white_noise(512 * 6, 3 * i + 3000), y = sum(x, white_noise(512 * 6, 3 * i + 3001));
    TransferEstimate const h = h1(cross_spectra(x, y, rate, {.segment = 512}));
    double const n = h.effective_averages;
    for (std::size_t k = 4; k < 252; k += 4, ++lines) {
      double const radius = confidence_radius(h.coherence[k], n),
                   off = std::abs(h.value[k] - 1.0) / std::abs(h.value[k]);
      inside += off <= radius ? 1 : 0;
      half += off <= radius / 2 ? 1 : 0;
      EXPECT_EQ(radius<1, h.coherence[k]> coherence_level(n)) << h.coherence[k];
    }
  }
  double const spread = std::sqrt(0.05 * 0.95 / lines);
  EXPECT_NEAR(inside / lines, 0.95, 5 * spread);
  EXPECT_LT(half / lines, 0.95 - 5 * spread) << "negative control";
}

// R6.05: a known second-order system is recovered to 1 % by H1 when noise is in the output; H2 is too large there by
// the noise, and the two change places with noise in the input.
TEST(CrossSpectra, SecondOrderSystemR6_05) {
  testing::Oscillator const system{20, 5, rate};
  std::vector<double> const x = white_noise(256 * 1600, 7), y = system.driven(x);
  double const loud = std::abs(system.response(20));
  std::vector<double> const noisy_y = sum(y, white_noise(x.size(), 8, 0.3 * loud)),
                            noisy_x = sum(x, white_noise(x.size(), 9, 0.5));
  WelchSettings const settings{.segment = 2048};
  CrossSpectra const of_y = cross_spectra(x, noisy_y, rate, settings), of_x = cross_spectra(noisy_x, y, rate, settings);
  TransferEstimate const good = h1(of_y), high = h2(of_y), low = h1(of_x), right = h2(of_x);
  double pulls = 0, count = 0, phases = 0;
  for (std::size_t k = 8 * 12; k <= 8 * 28; ++k, ++count) {
    std::complex<double> const truth = system.response(good.hz[k]);
    pulls += std::pow((std::abs(good.value[k]) - std::abs(truth)) / good.modulus_sigma[k], 2);
    phases += std::pow(std::arg(good.value[k] / truth) / good.phase_sigma[k], 2);
    double const size = std::abs(truth);
    EXPECT_NEAR(std::abs(low.value[k]), size / 1.25, 5 * low.modulus_sigma[k]) << "noise in the input: too small";
    EXPECT_NEAR(std::abs(right.value[k]), size, 5 * right.modulus_sigma[k]);
    EXPECT_GT(std::abs(high.value[k]), std::abs(good.value[k]));
  }
  EXPECT_NEAR(pulls / count, 1, 0.35) << "the errors stated are those seen";
  EXPECT_NEAR(phases / count, 1, 0.35);
  double ratio = 0, weight = 0;  // of all lines together: far below 1 %
  for (std::size_t k = 8 * 12; k <= 8 * 28; ++k) {
    double const w = std::pow(std::abs(good.value[k]) / good.modulus_sigma[k], 2);
    ratio += w * std::abs(good.value[k] / system.response(good.hz[k]));
    weight += w;
  }
  EXPECT_NEAR(ratio / weight, 1, 0.01);
}

TEST(CrossSpectra, ADelayTurnsThePhaseDown) {  // 3 samples: -360 deg f tau; the control of another sign would rise
  std::vector<double> const x = white_noise(64 * 1024, 11);
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t i = 3; i < x.size(); ++i) y[i] = 2 * x[i - 3];
  TransferEstimate const t = h1(cross_spectra(x, y, rate, {.segment = 1024}));
  for (std::size_t const k : {20u, 40u, 80u}) {
    EXPECT_NEAR(std::arg(t.value[k]), -2 * pi * t.hz[k] * 3 / rate, 0.01);
    EXPECT_NEAR(std::abs(t.value[k]), 2, 0.02);
  }
}

TEST(CrossSpectra, MedianAndUnequalLengthsAreErrors) {
  std::vector<double> const x(100, 1.0), y(99, 1.0);
  EXPECT_THROW(cross_spectra(x, y, rate, {.segment = 10}), InputError);
  EXPECT_THROW(cross_spectra(x, x, rate, {.segment = 10, .average = Average::median}), InputError);
}

}  // namespace
}  // namespace straytrace::signal_cross_spectra
