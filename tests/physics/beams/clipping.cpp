// SPDX-License-Identifier: BSD-3-Clause
// Loss of a Gaussian beam at an aperture (docs/theory/beams.md, eq. 5.5, 5.6; cases A8, B8; R2.26).
#include <gtest/gtest.h>

#include "beams/cavity_mode.hpp"
#include "beams/overlap.hpp"
#include "support/beams_support.hpp"
#include "support/statistics.hpp"

namespace straytrace::beams_clipping {
namespace {

using testing::deviation, testing::Dice;
constexpr double nd_yag = 1.064e-6;  // m
TEST(clipping, centred_apertures_a8_b8) {
  EXPECT_LT(deviation(clipped_share(0.170, 0.058), 3.4513e-8), 2e-5);
  EXPECT_LT(deviation(clipped_share(0.165, 0.058), 9.3427e-8), 2e-5);
  EXPECT_GT(deviation(clipped_share(0.165, 2 * 0.058), 9.3427e-8), 0.1);  // a diameter taken for a radius
  double const w = cavity_mode(39, infinity, 57, nd_yag).w2;
  EXPECT_LT(clipped_share(0.020, w), 1e-12);
  EXPECT_LT(deviation(clipped_share(0.020, 5.3e-3), 4.3e-13), 0.01);
  EXPECT_LT(deviation(clipped_share(0.015, 5.3e-3), std::exp(-450 / 28.09)), 1e-12);
  EXPECT_EQ(clipped_share(infinity, 1), 0);
  EXPECT_EQ(clipped_share(0, 1), 1);
}

TEST(clipping, numbers_of_r2_26) {
  EXPECT_NEAR(1 - clipped_share(1, 1), 0.86466, 5e-6);
  EXPECT_NEAR(1 - clipped_share(pi / 2, 1), 0.99281, 5e-6);
  EXPECT_LT(deviation(clipped_share(2.5, 1), 3.73e-6), 2e-3);
  EXPECT_LT(deviation(clipped_share(0.175, 58.05e-3), 1.277e-8), 5e-4);
  EXPECT_GT(deviation(clipped_share(0.175, 58.02e-3), 1.277e-8), 5e-3);  // the mode of 2999.8 m
}

// Marcum's function by Simpson's rule.
double marcum_q(double a, double b) {
  constexpr int steps = 10000;
  double const step = 20.0 / steps;
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    double const x = b + i * step, weight = i == 0 || i == steps ? 1 : i % 2 ? 4 : 2;
    sum += weight * x * std::exp(-(x * x + a * a) / 2) * std::cyl_bessel_i(0, a * x);
  }
  return sum * step / 3;
}

// Eq. 5.6 (A8), also where the loss is far below rounding of 1: three ways to 1e-9 relative.
TEST(clipping, apertures_off_the_beam_a8) {
  double const w = 0.058;
  EXPECT_EQ(clipped_share(0.165, w, 0), clipped_share(0.165, w));
  for (double a : {0.03, 0.06, 0.165, 0.22})
    for (double d : {1e-4, 0.01, 0.03, 0.1}) {
      double const exact = clipped_share(a, w, d);
      EXPECT_LT(deviation(marcum_q(2 * d / w, 2 * a / w), exact), 1e-9) << a << " " << d;
      EXPECT_LT(deviation(clipped_share(a, {w, w}, {0.6 * d, -0.8 * d}), exact), 1e-9) << a << " " << d;
      EXPECT_EQ(clipped_share(a, w, -d), exact);
      if (d > 1e-3) {
        EXPECT_GT(deviation(marcum_q(d / w, 2 * a / w), exact), 1e-3);  // one factor 2 forgotten
        EXPECT_GT(deviation(clipped_share(a, w), exact), 1e-3);         // the offset forgotten
      }
    }
  double const tiny = clipped_share(0.020, 5.3e-3, 1e-3);
  EXPECT_LT(tiny, 1e-11);
  EXPECT_LT(deviation(marcum_q(2 / 5.3, 40 / 5.3), tiny), 1e-9);
}

// A spot far smaller than the aperture sees a straight edge; far inside nothing, far outside all is lost.
TEST(clipping, small_spot_at_the_rim) {
  double const w = 1e-4, a = 0.5;
  for (double inside : {-2.0, -0.5, 0.0, 1.0, 2.0}) {
    double const edge = 0.5 * std::erfc(std::sqrt(2.0) * inside);
    EXPECT_LT(deviation(clipped_share(a, w, a - inside * w), edge), 1e-3);
    EXPECT_LT(deviation(clipped_share(a, {w, w}, {0, a - inside * w}), edge), 1e-3);
    EXPECT_GT(deviation(0.5 * std::erfc(inside), edge) + (inside == 0), 1e-3);  // w as the 1/e radius
  }
  EXPECT_EQ(clipped_share(a, w, a + 30 * w), 1);
  EXPECT_EQ(clipped_share(a, w, a - 30 * w), 0);
}

// Random points of the spot; for elliptic ones the axes exchanged must be noticed.
testing::SampleMean outside(double a, std::array<double, 2> w, std::array<double, 2> d) {
  constexpr int n = 300000;
  Dice dice(1);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double const rho = std::sqrt(-0.5 * std::log(dice.between(0, 1))), phi = dice.between(0, 2 * pi);
    sum += std::hypot(d[0] + w[0] * rho * std::cos(phi), d[1] + w[1] * rho * std::sin(phi)) > a;
  }
  double const mean = sum / n;
  return {mean, std::sqrt(mean * (1 - mean) / n), n};
}

TEST(clipping, agrees_with_sampling_a8) {
  double const w = 0.058;
  for (auto [a, d] : {std::pair{0.058, 0.0}, {0.06, 0.01}, {0.06, 0.03}, {0.08, 0.05}}) {
    double const exact = clipped_share(a, w, d);
    testing::SampleMean const found = outside(a, {w, w}, {0.6 * d, 0.8 * d});
    testing::expect_mean("clipped", found, exact, 0.05 * exact);
    testing::expect_rejected("other w", outside(a, {1.05 * w, w}, {d, 0}), exact);
    if (d > 0) testing::expect_rejected("offset forgotten", found, clipped_share(a, w));
  }
}

TEST(clipping, of_elliptic_beams_agrees_with_sampling) {
  for (auto [a, wx, wy, dx, dy] :
       {std::array{0.06, 0.058, 0.03, 0.02, 0.01}, {0.04, 0.02, 0.06, 0.03, 0.0}, {0.03, 0.01, 0.05, 0.0, 0.04}}) {
    testing::SampleMean const found = outside(a, {wx, wy}, {dx, dy});
    testing::expect_mean("clipped", found, clipped_share(a, {wx, wy}, {dx, dy}), 0.05 * found.mean);
    EXPECT_GT(std::fabs(found.mean - clipped_share(a, {wy, wx}, {dx, dy})), 5 * found.std_error);
    EXPECT_NEAR(clipped_share(a, {wy, wx}, {dy, dx}), clipped_share(a, {wx, wy}, {dx, dy}), 1e-12);
  }
}

// Nearly circular: the quadrature goes over into eq. 5.6.
TEST(clipping, elliptic_limit_is_eq_5_6) {
  for (double d : {0.0, 0.02, 0.09}) {
    double const exact = clipped_share(0.12, 0.058, d);
    EXPECT_LT(deviation(clipped_share(0.12, {0.058 * (1 + 1e-8), 0.058}, {d, 0}), exact), 1e-6);
    EXPECT_GT(deviation(clipped_share(0.12, {0.058 * 1.01, 0.058}, {d, 0}), exact), 1e-3);
  }
}

// A beam in space at a round hole: moved along the beam, off it, tilted. The hole is seen as an ellipse under an angle:
// the spot on its screen is longer by 1/cos.
TEST(clipping, of_a_mode_at_a_hole_in_a_screen) {
  Mode const m = elliptic_mode({}, unit({1, 1, 0}), {0, 0, 1}, {2e-3, 1e-3}, {0.1, -0.2}, nd_yag);
  double const z = 1.5;
  Spot const there = spot(propagated(m, z));
  Vec3 const off = 1e-3 * there.axis + 5e-4 * cross({0, 0, 1}, there.axis), centre = Vec3{0, 0, z} - off;
  double const straight = clipped_share(Aperture{centre, {0, 0, 1}, 3e-3}, m);
  EXPECT_LT(deviation(straight, clipped_share(3e-3, {there.major, there.minor}, {1e-3, 5e-4})), 1e-9);
  EXPECT_LT(deviation(clipped_share(Aperture{centre, {0, 0, -1}, 3e-3}, m), straight), 1e-9);
  EXPECT_GT(deviation(straight, clipped_share(3e-3, {there.minor, there.major}, {1e-3, 5e-4})), 1e-2);
  // Turned by 60 degrees about the short axis.
  Vec3 const normal = unit(0.5 * Vec3{0, 0, 1} + std::sqrt(0.75) * there.axis);
  double const tilted = clipped_share(Aperture{Vec3{0, 0, z}, normal, 3e-3}, m);
  EXPECT_LT(deviation(tilted, clipped_share(3e-3, {2 * there.major, there.minor}, {0, 0})), 1e-9);
  EXPECT_GT(deviation(tilted, clipped_share(Aperture{Vec3{0, 0, z}, {0, 0, 1}, 3e-3}, m)), 0.1);
  Mode const round = circular_mode({}, {0, 0, 1}, 2e-3, 0, nd_yag);
  double const w = spot(propagated(round, z)).major;
  EXPECT_LT(deviation(clipped_share(Aperture{{1e-3, 0, z}, {0, 0, 1}, 3e-3}, round), clipped_share(3e-3, w, 1e-3)),
            1e-9);
}

}  // namespace
}  // namespace straytrace::beams_clipping
