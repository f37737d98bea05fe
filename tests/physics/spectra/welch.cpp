// SPDX-License-Identifier: BSD-3-Clause
// Averaged periodograms (R2.15): scale, sides, axis, error.
#include "spectra/welch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "support/recorded.hpp"

namespace straytrace::signal_welch {
namespace {

constexpr double rate = 10e3;
constexpr Window windows[] = {Window::rectangular, Window::hann, Window::hamming, Window::blackman};

std::vector<double> white(std::size_t count, std::uint64_t seed) {
  Rng rng(seed, 0, 0, Stream::source);
  std::vector<double> x(count);
  for (double& v : x) v = std::sqrt(-2 * std::log(1 - rng.uniform())) * std::cos(2 * pi * rng.uniform());
  return x;
}

std::vector<double> sine(std::size_t count, double hz, double amplitude = 1) {
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = amplitude * std::sin(2 * pi * hz * double(i) / rate);
  return x;
}

double power(WelchSpectrum const& s) {
  double sum = 0;
  for (double const p : s.psd) sum += p * s.hz[1];
  return sum;
}

TEST(Welch, WhiteNoiseR2_15) {  // sigma 1, 10 kHz: 2/rate = 2.0e-4 one-sided; mean over bins, 5 standard errors
  std::vector<double> const x = white(2'000'000, 1);
  for (Window const w : windows) {
    WelchSpectrum const s = welch(x, rate, {.segment = 4000, .window = w});
    double mean = 0;
    for (std::size_t k = 2; k + 2 < s.psd.size(); ++k) mean += s.psd[k] / double(s.psd.size() - 4);
    double const tolerance = 5 * 2e-4 / std::sqrt(double(x.size()) / 2);
    EXPECT_NEAR(mean, 2e-4, tolerance * 2);  // windows use half of the samples and more
    EXPECT_GT(std::fabs(mean - 1e-4), 0.4e-4) << "control: two-sided";
  }
}

TEST(Welch, UnitSineR2_15) {  // Hann, 4000 samples: ENBW 1.5 bins = 3.75 Hz, peak 1/(2 ENBW) = 0.13333 at its frequency
  WelchSpectrum const s = welch(sine(40000, 1000), rate, {.segment = 4000});
  EXPECT_NEAR(s.noise_bandwidth, 3.75, 1e-9);
  EXPECT_NEAR(s.psd[400], 0.13333, 5e-6);
  EXPECT_DOUBLE_EQ(s.hz[400], 1000);        // axis: rate/n per step
  EXPECT_NE(400 * rate / 3999, s.hz[400]);  // control: rate/(n - 1)
  EXPECT_NEAR(power(s), 0.5, 1e-9);         // variance of a sine
  EXPECT_NEAR(s.psd[398] / s.psd[400], 0, 1e-12);
  EXPECT_NEAR(s.psd[399] / s.psd[400], 0.25, 1e-9);
  for (auto const& [window, bins] :
       {std::pair{Window::rectangular, 1.0}, {Window::hamming, 1.3628}, {Window::blackman, 1.7268}})
    EXPECT_NEAR(welch(sine(8000, 1000), rate, {.segment = 4000, .window = window}).noise_bandwidth / 2.5, bins, 1e-4);
}

TEST(Welch, ZeroAndNyquistAreNotDoubledR2_15) {  // Parseval: the integral is the mean square, whatever is in the ends
  std::vector<double> level(1000, 3.0), alternating(1000), mixed = white(1000, 2);
  for (std::size_t i = 0; i < 1000; ++i) alternating[i] = i % 2 == 0 ? 2 : -2;
  WelchSettings const whole{.segment = 1000, .overlap = 0, .window = Window::rectangular, .detrend = Detrend::none};
  WelchSpectrum const dc = welch(level, rate, whole), nyquist = welch(alternating, rate, whole);
  EXPECT_NEAR(power(dc), 9, 1e-9);
  EXPECT_NEAR(dc.psd[0] * 10, 9, 1e-9);  // 10 Hz per bin; doubled it were 18
  EXPECT_NEAR(nyquist.psd.back() * 10, 4, 1e-9);
  EXPECT_EQ(nyquist.hz.back(), 5000);
  double square = 0;
  for (double const x : mixed) square += x * x / 1000;
  EXPECT_NEAR(power(welch(mixed, rate, whole)), square, 1e-9);
  // An odd segment has no bin at half the rate, and its last one is doubled.
  std::vector<double> const odd(mixed.begin(), mixed.begin() + 999);
  square = 0;
  for (double const x : odd) square += x * x / 999;
  WelchSettings nine = whole;
  nine.segment = 999;
  EXPECT_NEAR(power(welch(odd, rate, nine)), square, 1e-9);
}

TEST(Welch, DetrendTakesTheMeanOfEachSegment) {
  std::vector<double> x = sine(8000, 1000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += i < 4000 ? 5 : 7;
  WelchSettings s{.segment = 4000, .overlap = 0};
  EXPECT_LT(welch(x, rate, s).psd[0], 1e-20);
  s.detrend = Detrend::none;
  EXPECT_GT(welch(x, rate, s).psd[0], 1);
}

TEST(Welch, ErrorsAreThoseOfRepeatedSeries) {  // spread over 400 series against the error stated, to 10 %
  for (double const overlap : {0.0, 0.5, 0.75}) {
    double sum = 0, square = 0, stated = 0, ends = 0;
    constexpr int series = 400;
    std::size_t bins = 0;
    for (int i = 0; i < series; ++i) {
      WelchSpectrum const s = welch(white(4096, 100 + std::uint64_t(i)), rate,
                                    {.segment = 512, .overlap = overlap, .detrend = Detrend::none});
      for (std::size_t k = 8; k < 248; k += 4, ++bins) {
        sum += s.psd[k];
        square += s.psd[k] * s.psd[k];
        stated += s.sigma[k] / s.psd[k];
      }
      ends += std::pow(s.psd.back() - 1e-4, 2) / series;
    }
    double const mean = sum / double(bins), spread = std::sqrt(square / double(bins) - mean * mean) / mean;
    EXPECT_NEAR(stated / double(bins) / spread, 1, 0.1) << overlap;
    EXPECT_NEAR(std::sqrt(ends) / 1e-4 / (std::sqrt(2) * spread), 1, 0.2) << overlap;
    std::size_t const segments = overlap == 0 ? 8 : overlap == 0.5 ? 15 : 29;
    if (overlap == 0.75) {
      EXPECT_GT(spread * std::sqrt(double(segments)), 1.3) << "control: as if they were independent";
    }
  }
}

TEST(Welch, ImpossibleSegmentsAreErrors) {
  std::vector<double> const x(100, 1.0);
  EXPECT_THROW(welch(x, rate, {.segment = 101}), InputError);
  EXPECT_THROW(welch(x, rate, {.segment = 1}), InputError);
  EXPECT_THROW(welch(x, rate, {.segment = 10, .overlap = 1}), InputError);
  EXPECT_THROW(welch(x, 0, {.segment = 10}), InputError);
}

}  // namespace
}  // namespace straytrace::signal_welch
