// SPDX-License-Identifier: BSD-3-Clause
// Motion drawn, recorded, filtered (R4.04; docs/theory/conventions.md).
#include <numbers>

#include "noise/time_domain/phase_sum.hpp"
#include "physics/noise/support.hpp"
#include "spectra/fourier.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing {
namespace {

double power(std::vector<double> const& x) {
  double sum = 0;
  for (double v : x) sum += v * v / double(x.size());
  return sum;
}

std::vector<double> const& only(MotionSeries const& m) { return m.coordinates.at(0).position; }

// Power of the line k of a period, one-sided.
double line_power(std::vector<double> const& x, std::size_t k) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += x[i] * std::polar(1.0, -2 * pi * double(k * i % x.size()) / double(x.size()));
  return 2 * std::norm(sum / double(x.size()));
}

TEST(MotionSeries, MeanPowerOfEveryBinIsTheIntegralOfTheSpectrum) {
  Spectrum const s = gaussian_line(3, 0.4, 1e-6);
  MotionSet const motion = moving({s});
  Sampler in_bin, all;
  for (std::uint32_t r = 0; r < 4000; ++r) {
    std::vector<double> const x = only(draw_motion(motion, {0, 64, 256}, 5, r));
    in_bin.add(line_power(x, 11) / s.power(10.5 * 0.25, 11.5 * 0.25));
    all.add(power(x) / s.total());
  }
  expect_mean("power of a bin", in_bin.mean(), 1, 0.2);
  expect_mean("variance", all.mean(), 1, 0.1);
  expect_rejected("control: two-sided", in_bin.mean(), 0.5);
  double const spread = in_bin.mean().std_error * std::sqrt(4000);  // exponential distribution: Gaussian motion
  EXPECT_NEAR(spread, 1, 0.1);
}

TEST(MotionSeries, TwiceTheRateIsTheSameMotion) {
  MotionSet const motion = moving({power_law_asd(1e-6, 1, -2, 0.1, 20)});
  std::vector<double> const slow = only(draw_motion(motion, {0, 64, 640}, 5, 3)),
                            fast = only(draw_motion(motion, {0, 128, 1280}, 5, 3)),
                            other = only(draw_motion(motion, {0, 64, 640}, 6, 3));
  for (std::size_t i = 0; i < slow.size(); ++i) EXPECT_NEAR(slow[i], fast[2 * i], 1e-15);
  EXPECT_GT(std::fabs(slow[100] - other[100]), 1e-9);  // control: another seed
}

TEST(MotionSeries, VelocityIsTheSlope) {
  MotionSet motion = moving({power_law_asd(1e-6, 1, -2, 0.1, 20)});
  motion.inputs.push_back(tone(7, 1e-6));
  motion.inputs.push_back({"creep", {}, 0, {{BodyId{0}, 2, 2e-6}}, true});
  MotionSeries const m = draw_motion(motion, {0, 4096, 4096}, 5);
  std::vector<double> const &x = only(m), &v = m.coordinates[0].velocity;
  for (std::size_t i = 1; i + 1 < x.size(); i += 50)
    EXPECT_NEAR(v[i], (x[i + 1] - x[i - 1]) * 2048, 2e-8) << i;  // of about 5e-5
}

TEST(MotionSeries, AToneAndItsRecordingAreTheSame) {  // R4.04: 1e-12
  MotionSet const drawn = [] {
    MotionSet m = moving({Spectrum()});
    m.inputs = {tone(1.14, 1e-6)};
    return m;
  }();
  MotionSeries const sampled = draw_motion(drawn, {1000, 256, 2560}, 1);
  auto const recording = std::make_shared<TimeSeries>(TimeSeries{"wall", "m", 1000, 256, only(sampled)});
  MotionSet replayed = moving({Spectrum()});
  replayed.inputs = {{"wall", {}, 0, {{BodyId{0}, 2, 1}}, false, recording}};
  MotionSeries const again = draw_motion(replayed, {1000, 256, 2560}, 1);
  for (std::size_t i = 0; i < 2560; ++i) EXPECT_LT(two_k * std::fabs(only(again)[i] - only(sampled)[i]), 1e-12);
  // On a clock four times as fast, away from the ends.
  MotionSeries const finer = draw_motion(replayed, {1002, 1024, 4096}, 1);
  MotionSeries const truth = draw_motion(drawn, {1000, 1024, 10240}, 1);
  for (std::size_t i = 0; i < 4096; ++i) EXPECT_NEAR(only(finer)[i], only(truth)[i + 2048], 1e-11) << i;
  EXPECT_THROW(draw_motion(replayed, {995, 256, 2560}, 1), InputError);
  EXPECT_THROW(draw_motion(replayed, {1000, 256, 2570}, 1), InputError);
}

TEST(MotionSeries, ATransferFunctionDelays) {  // convention exp(-2 pi i f t)
  auto const low_pass = std::make_shared<TransferFunction>(std::vector<double>{}, std::vector<double>{2}, 1);
  TimeSeries step{"step", "m", 0, 256, std::vector<double>(2560)};
  for (std::size_t i = 1280; i < 2560; ++i) step.samples[i] = 1;
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {
      {"step", {}, 0, {{BodyId{0}, 2, 1, low_pass}}, false, std::make_shared<TimeSeries>(std::move(step))}};
  std::vector<double> const x = only(draw_motion(motion, {0, 256, 2560}, 1));
  EXPECT_NEAR(x[1000], 0, 0.01);  // a control with the conjugate answers before the step
  for (std::size_t i : {1300u, 1320u, 1400u})
    EXPECT_NEAR(x[i], 1 - std::exp(-2 * pi * 2 * (double(i) - 1279.5) / 256), 0.02) << i;
}

TEST(MotionSeries, TransferFunctionsOfOneInputCorrelate) {
  auto const low_pass = std::make_shared<TransferFunction>(std::vector<double>{}, std::vector<double>{1}, 1);
  MotionSet motion = moving({gaussian_line(3, 0.2, 1e-6), gaussian_line(3, 0.2, 1e-9)});
  motion.inputs[0].gains.push_back({BodyId{1}, 2, 1, low_pass});
  MotionSeries const m = draw_motion(motion, {0, 64, 64 * 200}, 2);
  double const ratio = std::sqrt(power(m.coordinates[1].position) / power(m.coordinates[0].position));
  EXPECT_NEAR(ratio, 1 / std::sqrt(1 + 9.0), 0.005);
}

TEST(QuickLength, IsSmoothAndKeepsFactorsOfTwo) {
  for (std::size_t n : {1u, 2u, 7u, 61u, 10007u, 245760u, 999u}) {
    std::size_t const q = quick_length(n);
    EXPECT_GE(q, n);
    EXPECT_LT(double(q), 1.2 * double(n) + 1);
    EXPECT_EQ(quick_length(2 * n), 2 * q);
    std::size_t left = q;
    for (std::size_t p : {2u, 3u, 5u})
      while (left % p == 0) left /= p;
    EXPECT_EQ(left, 1u) << n;
  }
}

// A slow recording fills all of its time on a faster clock, up to the end of its last sample and no further.
TEST(MotionSeries, SlowRecordingsLastUntilTheirEnd) {
  for (double const slow : {16.0, 128.0, 512.0, 1000.0, 4096.0}) {
    TimeSeries x{"x", "m", 1e9, slow, {}};
    for (std::size_t i = 0; i < std::size_t(8 * slow); ++i)
      x.samples.push_back(std::sin(2 * std::numbers::pi * double(i) / slow));
    std::vector<double> const fast = resampled(x, {1e9, 1024, 8 * 1024});
    for (std::size_t i = 2048; i < 6144; i += 100)
      EXPECT_NEAR(fast[i], std::sin(2 * std::numbers::pi * double(i) / 1024), 1e-3) << slow;
    EXPECT_THROW(resampled(x, {1e9, 1024, 8 * 1024 + 80}), InputError) << slow;
  }
}

}  // namespace
}  // namespace straytrace::testing
