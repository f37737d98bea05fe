// SPDX-License-Identifier: BSD-3-Clause
// The edge of a shelf gives the effective motion (requirements R2.40, R2.41).
#include "analysis/fringes/shelf_edge.hpp"

#include <gtest/gtest.h>
#include <unsupported/Eigen/FFT>

#include <cmath>
#include <complex>

#include "physics/analysis/fringe_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::commission_shelf_edge {
namespace {

using namespace straytrace::testing;

constexpr double rate = 512, seconds = 80;
std::vector<Sine> const swing{{7e-6, 0.9, 0.3}, {2e-6, 0.31, 1}};

ShelfEdgeSettings band() {
  ShelfEdgeSettings s;
  s.low = 12;
  s.high = 110;
  s.factor = {0.3, 2};
  return s;
}

TimeSeries with_fringes(std::uint64_t seed, std::vector<Sine> const& sines, double factor, double floor = 3e-23,
                        double length = seconds) {
  TimeSeries h{"h", "1", 1e9, rate, detector_noise(seed, std::size_t(rate * length), rate, floor, 20)};
  add_fringes(h, sines, 2e-21, 0.3, factor, 0, 0.5);
  return h;
}

// R2.40: synthetic A_eff = 0.7 A, recovered to 2 %.
TEST(ShelfEdge, EffectiveAmplitudeR2_40) {
  ShelfEdgeFit const fit = fit_shelf_edge({with_fringes(1, swing, 0.7), {sine_motion(swing, 64, seconds)}}, band());
  EXPECT_EQ(fit.used, 8u);
  EXPECT_NEAR(fit.factor.value, 0.7, 0.02 * 0.7);
  for (EdgeStride const& e : fit.strides) EXPECT_NEAR(e.amplitude, 2e-21, 0.05 * 2e-21) << e.start;
}

// Two bodies: the witness of one alone sees another edge than there is; with both, the ratio comes out.
TEST(ShelfEdge, DifferentialMotionR2_40) {
  std::vector<Sine> const one{{7e-6, 0.9, 0.3}}, two{{5e-6, 0.9, 0.9}};
  TimeSeries const h = with_fringes(2, {one[0], {-0.8 * 5e-6, 0.9, 0.9}}, 1);
  FringeRecords const both{h, {sine_motion(one, 64, seconds), sine_motion(two, 64, seconds)}};
  ShelfEdgeSettings s = band();
  ShelfEdgeFit const alone = fit_shelf_edge({h, {both.witnesses[0]}}, s);
  EXPECT_LT(alone.factor.value, 0.8) << "the edge is lower than the formula says";
  s.ratio = {0.8, 0.8};
  EXPECT_NEAR(fit_shelf_edge(both, s).factor.value, 1, 0.02);
}

// A free ratio comes out with the factor; one that is held at a wrong value gives a wrong factor. Bodies that move at
// one frequency are one motion for a shelf, and give no ratio.
TEST(ShelfEdge, FreeRatioOfTwoBodiesR2_40) {
  ShelfEdgeSettings s = band();
  s.factor = {0.6, 1.6};
  auto const records = [&](double second, double length) {
    std::vector<Sine> const one{{7e-6, 0.9, 0.3}}, two{{5e-6, second, 0.9}};
    TimeSeries const h = with_fringes(3, {one[0], {-0.8 * 5e-6, second, 0.9}}, 1, 3e-23, length);
    return FringeRecords{h, {sine_motion(one, 64, length), sine_motion(two, 64, length)}};
  };
  FringeRecords const apart = records(0.55, 20);
  s.ratio = {0.5, 1.1};
  ShelfEdgeFit const fit = fit_shelf_edge(apart, s);
  EXPECT_FALSE(fit.ratio.at_end);
  EXPECT_NEAR(fit.ratio.value, 0.8, 3 * fit.ratio.sigma);
  EXPECT_NEAR(fit.factor.value, 1, 3 * fit.factor.sigma);
  EXPECT_LT(fit.ratio.sigma, 0.1);
  Fitted const untold = fit_shelf_edge(records(0.9, 10), s).ratio;
  EXPECT_TRUE(untold.at_end || untold.sigma > 0.25)
      << "many ratios are as good: " << untold.value << ", " << untold.sigma;
  s.ratio = {0.5, 0.5};
  ShelfEdgeFit const held = fit_shelf_edge(apart, s);
  EXPECT_GT(std::fabs(held.factor.value - 1), 3 * held.factor.sigma) << "control: ratio 0.5 instead of 0.8";
}

// |T(f)| of a port, 1 at 50 Hz or below.
using Response = double (*)(double hz);

void pass_through(TimeSeries& h, Response response) {
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> series(h.samples.begin(), h.samples.end()), lines;
  std::size_t const n = series.size();
  fft.fwd(lines, series);
  for (std::size_t k = 0; k < n; ++k) lines[k] *= response(double(std::min(k, n - k)) * rate / double(n));
  fft.inv(series, lines);
  for (std::size_t i = 0; i < n; ++i) h.samples[i] = series[i].real();
}

struct Pulls {
  int count = 0;
  double sum = 0, squares = 0;
  void add(double pull) { ++count, sum += pull, squares += pull * pull; }
  double mean() const { return sum / count; }
  double variance() const { return squares / count - mean() * mean(); }
  double variance_error() const { return std::sqrt(2.0 / count); }
};

// Pulls (found - true)/sigma of many records with a phase that swings by 390 rad, seen through ports of different
// slope. A variance off by 1.0, or errors wrong by a factor 1.4, would be seen.
TEST(ShelfEdge, ErrorsCoverTheScatterR2_40) {
  constexpr int trials = 30;
  constexpr double length = 20, metres = 390 * 1064e-9 / (8 * pi);
  Pulls all, halved, of_likelihood;
  Response const ports[] = {[](double) { return 1.0; }, [](double f) { return f / 50; },
                            [](double f) { return 1 / std::hypot(1, f / 50); }};
  for (std::size_t port = 0; port < 3; ++port)
    for (int i = 0; i < trials; ++i) {
      auto const trial = std::uint64_t(100 * port) + std::uint64_t(i);
      Rng rng(5, trial, 0, Stream::source);
      double const factor = 0.9 + 0.1 * rng.uniform();
      std::vector<Sine> const sway{{metres, 0.47, 2 * pi * rng.uniform()}};
      TimeSeries h{"h", "1", 1e9, rate, std::vector<double>(std::size_t(rate * length))};
      add_fringes(h, sway, 2e-21, 2 * pi * rng.uniform(), factor);
      pass_through(h, ports[port]);
      std::vector<double> const noise = detector_noise(1000 + trial, h.samples.size(), rate, 3e-23, 20);
      for (std::size_t k = 0; k < noise.size(); ++k) h.samples[k] += noise[k];
      ShelfEdgeSettings s = band();
      s.factor = {0.8, 1.1};
      ShelfEdgeFit const fit = fit_shelf_edge({h, {sine_motion(sway, 64, length)}}, s);
      ASSERT_EQ(fit.used, 2u);
      double const pull = (fit.factor.value - factor) / fit.factor.sigma;
      all.add(pull);
      halved.add(2 * pull);
      of_likelihood.add((fit.of_likelihood.value - factor) / fit.of_likelihood.sigma);
    }
  EXPECT_NEAR(all.mean(), 0, 3 / std::sqrt(all.count));
  EXPECT_NEAR(all.variance(), 1, 3 * all.variance_error());
  EXPECT_GT(halved.variance(), 1 + 3 * halved.variance_error()) << "control: errors half as large";
  EXPECT_GT(std::fabs(of_likelihood.variance() - 1), 3 * of_likelihood.variance_error())
      << "control: errors as if the shelf were Gaussian noise: " << of_likelihood.variance();
}

// No edge where there is no shelf.
TEST(ShelfEdge, FalseAlarms) {
  int alarms = 0;
  for (int i = 0; i < 12; ++i) {
    TimeSeries const h{"h", "1", 1e9, rate,
                       detector_noise(50 + std::uint64_t(i), std::size_t(rate * 20), rate, 1e-22, 20)};
    alarms += fit_shelf_edge({h, {sine_motion(swing, 64, 20)}}, band()).used > 0;
  }
  EXPECT_LE(alarms, 1);
}

}  // namespace
}  // namespace straytrace::commission_shelf_edge
