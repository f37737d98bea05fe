// SPDX-License-Identifier: BSD-3-Clause
// Accelerometer to displacement (docs/theory/motion.md, eq. 11.3; R6.05).
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.hpp"
#include "spectra/curve.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::signal_integration {
namespace {

constexpr double rate = 512;
constexpr std::size_t count = 512 * 40;

std::vector<double> tone(double hz, double amplitude, double phase = 0) {
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = amplitude * std::sin(2 * pi * hz * double(i) / rate + phase);
  return x;
}

// Largest difference in the middle half, over the largest value wanted.
double difference(std::vector<double> const& got, std::vector<double> const& wanted) {
  double worst = 0, largest = 0;
  for (std::size_t i = count / 4; i < 3 * count / 4; ++i) {
    worst = std::max(worst, std::abs(got[i] - wanted[i]));
    largest = std::max(largest, std::abs(wanted[i]));
  }
  return worst / largest;
}

TEST(Integration, AccelerationAt50HzR6_05) {  // 1e-4 m/s^2/sqrt(Hz) -> 1.013e-9 m/sqrt(Hz); controls: f, and omega once
  EXPECT_NEAR(integrated_asd(1e-4, 50, 2), 1.013e-9, 5e-13);
  EXPECT_NEAR(integrated_asd(1e-4, 50, 2), 1e-4 / (4 * pi * pi * 2500), 1e-22);
  EXPECT_GT(std::abs(1e-4 / (50.0 * 50) / 1.013e-9 - 1), 10);
  EXPECT_GT(std::abs(integrated_asd(1e-4, 50, 1) / 1.013e-9 - 1), 10);
}

TEST(Integration, InTheFrequencyDomainHasNoPhase) {  // -w^2 x = a: amplitude and sign of every sample
  double const f = 30.3, w = 2 * pi * f;
  TimeSeries const a = testing::series_with(tone(f, 2e6, 0.4), rate, "um/s^2");
  TimeSeries const x = integrated(a, 2, 0.5), v = integrated(a, 1, 0.5);
  EXPECT_EQ(x.unit, "m");
  EXPECT_EQ(v.unit, "m/s");
  EXPECT_LT(difference(x.samples, tone(f, -2 / (w * w), 0.4)), 1e-4);
  EXPECT_LT(difference(v.samples, tone(f, -2 / w, 0.4 + pi / 2)), 1e-4);
  EXPECT_GT(difference(x.samples, tone(f, 2 / (w * w), 0.4)), 1) << "control: without the sign";
  double const low = 1.0, high_pass = 1 / (1 + std::pow(0.5 / low, 4));  // (f/c)^4/(1 + (f/c)^4)
  TimeSeries const slow = integrated(testing::series_with(tone(low, 1), rate, "m/s^2"), 2, 0.5);
  EXPECT_LT(difference(slow.samples, tone(low, -high_pass / std::pow(2 * pi * low, 2))), 2e-3);
}

// A tone between half the corner and the corner: A/sqrt(2) times the difference of the two high passes (eq. 11.3).
TEST(Integration, MotionBelowTheCornerIsReported) {
  double const f = 0.9, w = 2 * pi * f, corner = 1.0;
  auto const kept = [&](double c) { return std::pow(f / c, 4) / (1 + std::pow(f / c, 4)); };
  TimeSeries const a = testing::series_with(tone(f, 1e-6 * w * w, 0.4), rate, "m/s^2");
  double const lost = 1e-6 / std::sqrt(2) * (kept(corner / 2) - kept(corner));
  EXPECT_NEAR(rms_below(a, 2, corner), lost, 5e-3 * lost);
  EXPECT_LT(rms_below(testing::series_with(tone(20, 1e-6 * w * w), rate, "m/s^2"), 2, corner), 1e-3 * lost)
      << "control: a tone far above";
  EXPECT_TRUE(std::isnan(rms_below(a, 2, 0.25))) << "40 s are five periods of half of it";
}

// Butterworth high pass of the order, f over its corner: s^n/prod(s - p_k).
std::complex<double> high_pass(int order, double ratio) {
  std::complex<double> const s(0, ratio);
  std::complex<double> h = 1;
  for (int k = 0; k < order; ++k) h *= s / (s - std::polar(1.0, pi / 2 + pi * (2 * k + 1) / (2.0 * order)));
  return h;
}

// The trapezoidal rule, (x cot x)^times, and modulus and phase of the causal high pass.
TEST(Integration, CausalIntegrationHasTheStatedResponse) {
  double const f = 20, w = 2 * pi * f, x = pi * f / rate, rule = x / std::tan(x);
  TimeSeries const a = testing::series_with(tone(f, 1), rate, "m/s^2");
  std::complex<double> const twice = high_pass(6, f), once = high_pass(4, f);
  std::vector<double> const wanted = tone(f, -rule * rule / (w * w) * std::abs(twice), std::arg(twice));
  EXPECT_LT(difference(integrated_causal(a, 2, 1).samples, wanted), 5e-3);
  EXPECT_LT(
      difference(integrated_causal(a, 1, 1).samples, tone(f, -rule / w * std::abs(once), std::arg(once) + pi / 2)),
      5e-3);
  EXPECT_GT(difference(wanted, tone(f, -rule * rule / (w * w))), 0.1) << "control: a high pass without phase";
  TimeSeries late = a;  // nothing comes before its cause
  std::fill(late.samples.begin(), late.samples.begin() + count / 2, 0.0);
  TimeSeries const out = integrated_causal(late, 2, 0.1);
  EXPECT_TRUE(std::all_of(out.samples.begin(), out.samples.begin() + count / 2, [](double v) { return v == 0; }));
}

TEST(Integration, AConstantOffsetDoesNotRunAway) {
  std::vector<double> level(count, 3.0);
  EXPECT_LT(std::abs(integrated(testing::series_with(level, rate, "m/s^2"), 2, 0.5).samples[count / 2]), 1e-9);
  double const last = integrated_causal(testing::series_with(level, rate, "m/s^2"), 2, 0.5).samples.back();
  EXPECT_LT(std::abs(last), 1e-6);
}

TEST(Integration, UnitsSayHowOften) {
  EXPECT_EQ(integrations_to_displacement("um/s^2"), 2);
  EXPECT_EQ(integrations_to_displacement("mm/s"), 1);
  EXPECT_EQ(integrations_to_displacement("nm"), 0);
  for (char const* wrong : {"V", "count", "1", "rad/s", "m^2"})
    EXPECT_THROW(integrations_to_displacement(wrong), InputError);
}

}  // namespace
}  // namespace straytrace::signal_integration
