// SPDX-License-Identifier: BSD-3-Clause
// Confidence of averaged periodograms, and the bias of their median (R2.15).
#include <gtest/gtest.h>

#include <algorithm>

#include "spectra/welch.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::signal_confidence {
namespace {

constexpr double rate = 1000;

// Share of lines whose interval holds the truth 2/rate. `effective`: replaced number of averages, 0: the one stated.
double covered(WelchSettings const& settings, std::size_t trials, bool as_if_independent) {
  double inside = 0, lines = 0;
  for (std::size_t i = 0; i < trials; ++i) {
    WelchSpectrum s = welch(testing::white_noise(settings.segment * 6, 500 + i), rate, settings);
    if (as_if_independent) s.effective_averages = double(s.segments);
    Interval const interval = confidence(s);
    for (std::size_t k = 4; k < settings.segment / 2 - 4; k += 4, ++lines)
      inside += interval.low[k] <= 2 / rate && 2 / rate <= interval.high[k] ? 1 : 0;
  }
  return inside / lines;
}

TEST(Confidence, CoversTheTrueValueIn95PerCent) {  // 60 trials of 62 lines: one standard error 0.36 %
  EXPECT_NEAR(covered({.segment = 512, .overlap = 0}, 60, false), 0.95, 0.015);
  EXPECT_NEAR(covered({.segment = 512, .overlap = 0.5}, 60, false), 0.95, 0.015);
  EXPECT_NEAR(covered({.segment = 512, .overlap = 0.75}, 60, false), 0.95, 0.015);
  EXPECT_LT(covered({.segment = 512, .overlap = 0.75}, 60, true), 0.92)
      << "control: overlapping segments as independent";
}

TEST(Confidence, OfTheMedianIsWider) {
  WelchSettings const settings{.segment = 512, .overlap = 0, .average = Average::median};
  EXPECT_NEAR(covered(settings, 60, false), 0.95, 0.03);
  EXPECT_LT(covered(settings, 60, true), 0.90) << "control: the median as precise as the mean";
}

TEST(Confidence, MedianHasNoBias) {  // its mean over many lines is that of the noise; without the correction ln 2 of it
  for (std::size_t const segments : {3u, 4u, 9u, 40u}) {
    double mean = 0, lines = 0;
    for (std::size_t i = 0; i < 40; ++i) {
      WelchSpectrum const s = welch(testing::white_noise(512 * segments, 900 + i), rate,
                                    {.segment = 512, .overlap = 0, .average = Average::median});
      for (std::size_t k = 4; k < 252; k += 4, ++lines) mean += s.psd[k];
    }
    double const spread = 2 / std::sqrt(lines * double(segments));
    EXPECT_NEAR(mean / lines * rate / 2, 1, 4 * spread) << segments;
  }
  EXPECT_EQ(median_bias(1), 1);
  EXPECT_EQ(median_bias(2), 1);
  EXPECT_DOUBLE_EQ(median_bias(3), 5.0 / 6);  // second of three: 1/3 + 1/2
  EXPECT_NEAR(median_bias(100001), std::log(2), 1e-5);
}

TEST(Confidence, MedianOverstatesALine) {  // of constant power nothing scatters, and the correction of 1/ln 2 remains
  std::vector<double> line(512 * 101);
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = std::sin(2 * pi * 32 * double(i) / 512);
  WelchSettings settings{.segment = 512, .overlap = 0};
  double const mean = welch(line, rate, settings).psd[32];
  settings.average = Average::median;
  EXPECT_NEAR(welch(line, rate, settings).psd[32] / mean, 1 / median_bias(101), 1e-9);
}

}  // namespace
}  // namespace straytrace::signal_confidence
