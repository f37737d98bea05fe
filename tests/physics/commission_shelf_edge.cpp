// SPDX-License-Identifier: BSD-3-Clause
// The edge of a shelf tells the effective motion (requirements R2.40, R2.41).
#include <gtest/gtest.h>

#include <cmath>

#include "commission/shelf_edge.hpp"
#include "fringe_support.hpp"
#include "recorded.hpp"

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
  ShelfEdgeFit const fit = fit_shelf_edge({with_fringes(1, swing, 0.7), {motion(swing, 64, seconds)}}, band());
  EXPECT_EQ(fit.used, 8u);
  EXPECT_NEAR(fit.factor.value, 0.7, 0.02 * 0.7);
  for (EdgeStride const& e : fit.strides) EXPECT_NEAR(e.amplitude, 2e-21, 0.05 * 2e-21) << e.start;
}

// Two bodies: the witness of one alone sees another edge than there is; with both, the ratio comes out.
TEST(ShelfEdge, DifferentialMotionR2_40) {
  std::vector<Sine> const one{{7e-6, 0.9, 0.3}}, two{{5e-6, 0.9, 0.9}};
  TimeSeries const h = with_fringes(2, {one[0], {-0.8 * 5e-6, 0.9, 0.9}}, 1);
  FringeRecords const both{h, {motion(one, 64, seconds), motion(two, 64, seconds)}};
  ShelfEdgeSettings s = band();
  ShelfEdgeFit const alone = fit_shelf_edge({h, {both.witnesses[0]}}, s);
  EXPECT_LT(alone.factor.value, 0.8) << "the edge is lower than the formula says";
  s.ratio = {0.8, 0.8};
  EXPECT_NEAR(fit_shelf_edge(both, s).factor.value, 1, 0.02);
}

// A free ratio comes out with the factor; one that is held at a wrong value gives a wrong factor. Bodies that move at
// one frequency are one motion to a shelf, and tell no ratio.
TEST(ShelfEdge, FreeRatioOfTwoBodiesR2_40) {
  ShelfEdgeSettings s = band();
  s.factor = {0.6, 1.6};
  auto const records = [&](double second, double length) {
    std::vector<Sine> const one{{7e-6, 0.9, 0.3}}, two{{5e-6, second, 0.9}};
    TimeSeries const h = with_fringes(3, {one[0], {-0.8 * 5e-6, second, 0.9}}, 1, 3e-23, length);
    return FringeRecords{h, {motion(one, 64, length), motion(two, 64, length)}};
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
  EXPECT_GT(std::fabs(held.factor.value - 1), 3 * held.factor.sigma) << "twin: ratio 0.5 instead of 0.8";
}

// Coverage of the error of the mean, and no edge where there is no shelf.
TEST(ShelfEdge, ErrorsAndFalseAlarms) {
  int within = 0, alarms = 0;
  for (int i = 0; i < 12; ++i) {
    FringeRecords r{with_fringes(20 + std::uint64_t(i), swing, 0.7, 1e-22, 20), {motion(swing, 64, 20)}};
    ShelfEdgeFit const fit = fit_shelf_edge(r, band());
    within += std::fabs(fit.factor.value - 0.7) < 2 * fit.factor.sigma;
    r.target.samples = detector_noise(50 + std::uint64_t(i), r.target.samples.size(), rate, 1e-22, 20);
    alarms += fit_shelf_edge(r, band()).used > 0;
  }
  EXPECT_GE(within, 10);
  EXPECT_LE(alarms, 1);
}

}  // namespace
}  // namespace straytrace::commission_shelf_edge
