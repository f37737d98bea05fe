// SPDX-License-Identifier: BSD-3-Clause
// Coupling of a band where slow motion of the same surface spreads what fast small motion makes (C.13).
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "support/signal_support.hpp"

namespace straytrace::commission_band_coupling {
namespace {

using namespace straytrace::testing;

constexpr double rate = 256, seconds = 64, gain = 2;
constexpr WelchSettings settings{.segment = 1024};

// Gaussian, flat from 68 to 72 Hz: sines of random phase that lie closer than a segment resolves.
std::vector<double> driven(double rms, std::uint64_t seed) {
  Rng rng(seed, 0, 0, Stream::source);
  std::vector<double> x(std::size_t(rate * seconds));
  int const lines = 120;
  for (int line = 0; line < lines; ++line) {
    double const w = 2 * pi * (68 + 4 * (line + rng.uniform()) / lines) / rate, start = 2 * pi * rng.uniform();
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += rms * std::sqrt(2.0 / lines) * std::sin(w * double(i) + start);
  }
  return x;
}

// Witness: the fast phase, rad. Target: G sin(slow + fast) and noise; slow motion of 10 rad rms reaches 5 Hz.
CrossSpectra stretch(double rms, std::uint64_t seed) {
  std::vector<double> const fast = driven(rms, 3 * seed);
  std::vector<double> y = white_noise(fast.size(), 3 * seed + 1, 0.02 * gain);
  double const at = double(seed);
  for (std::size_t i = 0; i < y.size(); ++i) {
    double const t = double(i) / rate;
    double const slow = 12 * std::sin(2 * pi * 0.21 * t + at) + 7 * std::sin(2 * pi * 0.33 * t + 2 * at);
    y[i] += gain * std::sin(slow + fast[i]);
  }
  return cross_spectra(channel("ACC", "rad", rate, fast), channel("H", "1", rate, y), settings);
}

// h = G sin(theta + z), z small: power G^2/2 of that of z, wherever theta spreads it, so H = G/sqrt(2). Controls: the
// part that is coherent with the witness, and single lines, which are flagged.
TEST(BandCoupling, SlowMotionSpreadsPowerAndKeepsIt) {
  double mean = 0, coherent = 0;
  int const trials = 16;
  double squares = 0;
  for (int i = 0; i < trials; ++i) {
    CrossSpectra const loud = stretch(0.2, 2 * std::uint64_t(i) + 1), still = stretch(0.02, 2 * std::uint64_t(i) + 2);
    BandCoupling const b = band_coupling(loud, still, 55, 85, settings);
    mean += b.factor / trials;
    squares += std::pow((b.factor - gain / std::sqrt(2)) / b.sigma, 2) / trials;
    EXPECT_FALSE(b.rises_at_low || b.rises_at_high);
    EXPECT_GT(b.sigma, 0);
    EXPECT_LT(b.sigma, 0.2 * b.factor);
    std::size_t const line = 70 * 4;
    coherent += std::abs(loud.cross[line]) / loud.input[line] / trials;
    EXPECT_EQ(measure_coupling(loud, still, {})[line - 1].flag, CouplingFlag::not_linear);
  }
  EXPECT_NEAR(mean, gain / std::sqrt(2), 0.04 * gain);
  EXPECT_GT(std::sqrt(squares), 0.5) << "an error twice too large";
  EXPECT_LT(std::sqrt(squares), 1.5) << "an error too small";
  EXPECT_LT(coherent, 0.5 * gain / std::sqrt(2)) << "negative control";
}

TEST(BandCoupling, BandThatCutsThePowerIsAWarning) {
  BandCoupling const b = band_coupling(stretch(0.2, 1), stretch(0.02, 2), 68, 72, settings);
  EXPECT_TRUE(b.rises_at_low && b.rises_at_high);
  EXPECT_LT(b.factor, 0.9 * gain / std::sqrt(2)) << "power outside the band is missing";
}

TEST(BandCoupling, WithoutARiseThereIsNoCoupling) {
  EXPECT_TRUE(std::isnan(band_coupling(stretch(0.02, 1), stretch(0.02, 2), 90, 110, settings).factor));
  EXPECT_TRUE(std::isnan(band_coupling(stretch(0.2, 1), stretch(0.02, 2), 500, 600, settings).factor)) << "no line";
}

}  // namespace
}  // namespace straytrace::commission_band_coupling
