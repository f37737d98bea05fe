// SPDX-License-Identifier: BSD-3-Clause
// Elementary functions against the standard library in 80-bit arithmetic. Bounds are in units of the last place (ulp)
// of the exact answer, over the ranges the trace uses.
#include "base/math/functions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/math/bessel.hpp"
#include "base/math/rng.hpp"
#include "support/chi_square.hpp"

namespace straytrace {
namespace {

constexpr long double pi_l = 3.141592653589793238462643383279502884L;
constexpr int draws = 100000;

double ulps(double value, long double exact) {
  double const rounded = static_cast<double>(exact);
  double const unit = std::nextafter(std::fabs(rounded), infinity) - std::fabs(rounded);
  return static_cast<double>(std::fabs(value - exact) / unit);
}

// Largest error in ulp of f(x) against exact(x), x drawn log-uniformly between low and high.
template <class F, class Exact>
double worst(double low, double high, F f, Exact exact) {
  double most = 0;
  Rng rng(1, 0, 0, Stream::source);
  for (int i = 0; i < draws; ++i) {
    double const x = low * std::pow(high / low, rng.uniform());
    most = std::fmax(most, ulps(f(x), exact(x)));
  }
  return most;
}

auto const sine = [](double x) { return sincos_turn(x).sin; };
auto const cosine = [](double x) { return sincos_turn(x).cos; };
auto const exact_sine = [](double x) { return std::sin(2 * pi_l * x); };
auto const exact_cosine = [](double x) { return std::cos(2 * pi_l * x); };

TEST(functions, sincos_turn_within_three_ulp_up_to_an_eighth_of_a_turn) {
  EXPECT_LT(worst(1e-12, 0.125, sine, exact_sine), 3);
  EXPECT_LT(worst(1e-12, 0.125, cosine, exact_cosine), 3);
}

TEST(functions, sincos_turn_within_3e_16_over_whole_turns) {
  double most = 0;
  Rng rng(2, 0, 0, Stream::source);
  for (int i = 0; i < draws; ++i) {
    double const x = 8 * rng.uniform() - 4;
    SinCos const a = sincos_turn(x);
    most = std::fmax(most, static_cast<double>(std::fabs(a.sin - exact_sine(x))));
    most = std::fmax(most, static_cast<double>(std::fabs(a.cos - exact_cosine(x))));
  }
  EXPECT_LT(most, 3e-16);
}

TEST(functions, sincos_turn_exact_at_quarter_turns) {
  double const expected[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
  for (int q = -8; q < 8; ++q) {
    SinCos const a = sincos_turn(0.25 * q);
    EXPECT_EQ(a.sin, expected[q & 3][0]) << q;
    EXPECT_EQ(a.cos, expected[q & 3][1]) << q;
  }
}

TEST(functions, log_within_two_ulp) {
  auto const exact = [](double x) { return std::log(static_cast<long double>(x)); };
  EXPECT_LT(worst(1e-150, 1e150, log_positive, exact), 2);
  EXPECT_LT(ulps(log_positive(1e-300), exact(1e-300)), 2);
  EXPECT_LT(ulps(log_positive(1e300), exact(1e300)), 2);
  EXPECT_LT(worst(0.5, 2, log_positive, exact), 2);
  EXPECT_EQ(log_positive(1), 0);
  EXPECT_LT(ulps(log_positive(1 - 0x1p-53), exact(1 - 0x1p-53)), 2);  // the largest number Rng gives
}

TEST(functions, exp_within_two_ulp) {
  auto const exact = [](double x) { return std::exp(static_cast<long double>(x)); };
  auto const negative = [](double x) { return exp_number(-x); };
  auto const exact_negative = [](double x) { return std::exp(-static_cast<long double>(x)); };
  EXPECT_LT(worst(1e-9, 709, exp_number, exact), 2);
  EXPECT_LT(worst(1e-9, 708, negative, exact_negative), 2);
  EXPECT_EQ(exp_number(-800), 0);
  EXPECT_EQ(exp_number(800), infinity);
  EXPECT_EQ(exp_number(0), 1);
}

// The rounding of the exponent is magnified by |y ln x|: at 5e-5 rad and n = 2.4 the bound is 41 ulp, 9e-15.
TEST(functions, power_error_grows_only_with_the_logarithm) {
  for (double y : {-3.0, -2.3986, -2.0, -1.0, 0.5, 1.8})
    for (double low : {1e-6, 5e-5, 1e-2}) {
      double const bound = 3 + 1.6 * std::fabs(y * std::log(low));
      auto const exact = [&](double x) { return std::pow(static_cast<long double>(x), y); };
      EXPECT_LT(worst(
                    low, 3.2, [&](double x) { return power_positive(x, y); }, exact),
                bound)
          << y << " " << low;
    }
}

TEST(functions, atan_within_five_ulp) {
  auto const exact = [](double x) { return std::atan(static_cast<long double>(x)); };
  EXPECT_LT(worst(1e-15, 1, atan_positive, exact), 5);
  EXPECT_LT(worst(1, 1e15, atan_positive, exact), 5);
  EXPECT_EQ(atan_positive(0), 0);
  EXPECT_EQ(atan_positive(infinity), pi / 2);
}

TEST(functions, atan_of_a_quotient) {
  auto const exact = [](double x) { return std::atan(static_cast<long double>(x)); };
  auto const quotient = [](double x) { return atan_ratio(3 * x, 3); };
  EXPECT_LT(worst(1e-15, 1e15, quotient, exact), 5);
  EXPECT_EQ(atan_ratio(0, 2), 0);
  EXPECT_EQ(atan_ratio(2, 0), pi / 2);
}

// The angle of a chord t = 2 sin(angle/2), squared, on both sides of the change of method at t^2 = 1/2. The control
// takes the chord for the angle.
TEST(functions, square_of_the_angle_of_a_chord) {
  auto const exact = [](double t2) {
    long double const angle = 2 * std::asin(std::sqrt(static_cast<long double>(t2)) / 2);
    return angle * angle;
  };
  EXPECT_LT(worst(1e-20, 0.5, angle2_of_chord2, exact), 3);
  EXPECT_LT(worst(0.5, 3.9, angle2_of_chord2, exact), 12);
  EXPECT_NEAR(angle2_of_chord2(4), pi * pi, 1e-14);
  EXPECT_EQ(angle2_of_chord2(0), 0);
  EXPECT_GT(worst(
                0.01, 0.5, [](double t2) { return t2; }, exact),
            1e12);
}

// Largest relative error of angle(a, b) for vectors 1e-9 to 3 rad apart, against 80-bit arithmetic on the same doubles.
template <class Angle>
double worst_angle(Angle angle) {
  double most = 0;
  Rng rng(3, 0, 0, Stream::source);
  for (int i = 0; i < draws; ++i) {
    double const z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z);
    SinCos const turn = sincos_turn(rng.uniform());
    Frame const f = Frame::around({r * turn.cos, r * turn.sin, z});
    double const theta = 1e-9 * std::pow(3e9, rng.uniform());
    SinCos const s = sincos_turn(theta / (2 * pi));
    Vec3 const a = f.e3, b = unit(s.cos * f.e3 + s.sin * f.e1);
    long double const ex = b.x - (long double)a.x, ey = b.y - (long double)a.y, ez = b.z - (long double)a.z;
    long double const x = a.y * ez - a.z * ey, y = a.z * ex - a.x * ez, w = a.x * ey - a.y * ex;  // a x (b - a)
    long double const along = (long double)a.x * b.x + (long double)a.y * b.y + (long double)a.z * b.z;
    long double const exact = std::atan2(std::sqrt(x * x + y * y + w * w), along);
    most = std::fmax(most, static_cast<double>(std::fabs(angle(a, b) / exact - 1)));
  }
  return most;
}

TEST(functions, angle_between_is_exact_for_small_angles) {
  EXPECT_LT(worst_angle(angle_between), 1e-13);  // 1e-9 rad apart, unequal lengths (1e-16) count in quadrature
  EXPECT_GT(worst_angle([](Vec3 a, Vec3 b) { return std::acos(std::fmin(1, dot(a, b))); }), 0.9);  // negative control
}

TEST(functions, angle_between_equal_and_opposite_vectors) {
  Vec3 const a = unit({1, 2, 3});
  EXPECT_EQ(angle_between(a, a), 0);
  EXPECT_EQ(angle_between(a, -a), pi);
}

// Requirements R3.21: a proper rotation for every axis, -z included. The control mirrors the frame.
double handedness_error(Frame const& f) {
  double most = std::fabs(dot(cross(f.e1, f.e2), f.e3) - 1);
  for (double d : {dot(f.e1, f.e2), dot(f.e2, f.e3), dot(f.e3, f.e1), length(f.e1) - 1, length(f.e2) - 1})
    most = std::fmax(most, std::fabs(d));
  return most;
}

TEST(vectors, frames_are_right_handed) {
  for (Vec3 axis :
       {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, unit({1, 1, 1}), unit({0.5, 0, -1})}) {
    Frame const f = Frame::around(axis);
    EXPECT_LT(handedness_error(f), 5e-16);
    EXPECT_GT(handedness_error({f.e1, -f.e2, f.e3}), 1);
    EXPECT_LT(length(f.to_world(f.to_local({3, -1, 2})) - Vec3{3, -1, 2}), 3e-15);
  }
}

// Requirements R3.22: angle in = angle out to 1e-15. The control forgets the factor 2.
TEST(vectors, reflection_keeps_the_angle) {
  Rng rng(4, 0, 0, Stream::source);
  auto const random_unit = [&] { return unit({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5}); };
  double most = 0, control = 0;
  for (int i = 0; i < 1000; ++i) {
    Vec3 const d = random_unit(), n = random_unit();
    most = std::fmax(most, std::fabs(dot(reflected(d, n), n) + dot(d, n)));
    control = std::fmax(control, std::fabs(dot(d - dot(d, n) * n, n) + dot(d, n)));
  }
  EXPECT_LT(most, 1e-15);
  EXPECT_GT(control, 1e-3);
}

// Azimuth against atan2; tolerance 4 units in the last place of a turn. The control takes the wrong half of the plane.
TEST(functions, turn_of_is_the_azimuth) {
  Rng rng(8, 0, 0, Stream::source);
  double most = 0, control = 0;
  for (int i = 0; i < 20000; ++i) {
    double const x = rng.uniform() - 0.5, y = (rng.uniform() - 0.5) * std::pow(10, -6 * rng.uniform());
    double const exact = std::atan2(y, x) / (2 * pi);
    most = std::fmax(most, std::fabs(turn_of(x, y) - (exact < 0 ? exact + 1 : exact)));
    control = std::fmax(control, std::fabs(turn_of(-x, y) - (exact < 0 ? exact + 1 : exact)));
  }
  EXPECT_LT(most, 4 * 0x1p-53);
  EXPECT_GT(control, 0.4);
  EXPECT_EQ(turn_of(1, 0), 0);
  EXPECT_EQ(turn_of(0, 1), 0.25);
  EXPECT_EQ(turn_of(-1, 0), 0.5);
  EXPECT_EQ(turn_of(0, -1), 0.75);
  EXPECT_EQ(turn_of(0, 0), 0);
}

// The same place as that of std::lower_bound, with equal values, in parts of a list, and where there is none.
TEST(first_where, is_a_binary_search) {
  std::vector<double> const values{-2, -1, -1, 0, 3, 3, 3, 8};
  for (std::uint32_t low = 0; low <= values.size(); ++low)
    for (std::uint32_t end = low; end <= values.size(); ++end)
      for (double const x : {-3.0, -1.0, 0.0, 1.0, 3.0, 8.0, 9.0}) {
        auto const first = values.begin() + low, last = values.begin() + end;
        auto const found = first_where(low, end, [&](std::uint32_t i) { return values[i] >= x; });
        EXPECT_EQ(found, low + std::uint32_t(std::lower_bound(first, last, x) - first)) << x;
      }
  EXPECT_EQ(first_where(3, 2, [](std::uint32_t) { return true; }), 3u);  // before the start
}

// Upper tails of chi-square against published tables (Abramowitz and Stegun, table 26.8), which the contracts rest on.
TEST(statistics, chi_square_tail) {
  EXPECT_NEAR(testing::chi_square_tail(3.841458821, 1), 0.05, 1e-9);
  EXPECT_NEAR(testing::chi_square_tail(18.30703805, 10), 0.05, 1e-9);
  EXPECT_NEAR(testing::chi_square_tail(149.4492528, 100) / 0.001, 1, 1e-6);
  EXPECT_NEAR(testing::chi_square_tail(30, 2) / std::exp(-15), 1, 1e-12);
}

// exp(-x) I_n(x) by the series of exp(x) = I_0 + 2 (I_1 + I_2 + ...) and by the standard library, which overflows
// beyond x = 700. The control is the upward recurrence, which is not stable.
TEST(functions, scaled_bessel_functions_of_all_orders) {
  for (double const x : {0.0, 0.5, 20.0, 60.0, 600.0, 1.1e4, 4e5}) {
    int const most = 40 + int(10 * std::sqrt(x));
    std::vector<double> const values = scaled_bessels(most, x);
    double sum = values[0];
    for (int n = 1; n <= most; ++n) sum += 2 * values[std::size_t(n)];
    EXPECT_NEAR(sum, 1, 1e-9) << x;
    for (int n = 0; x < 700 && n <= 100 && n <= most; n += 20) {
      double const exact = std::exp(-x) * std::cyl_bessel_i(double(n), x);
      EXPECT_NEAR(values[std::size_t(n)], exact, 1e-9 * exact) << n << ' ' << x;
    }
  }
  double below = scaled_bessel(0, 60), here = scaled_bessel(1, 60);
  for (int n = 1; n < 60; ++n) below = std::exchange(here, below - 2 * n / 60. * here);
  EXPECT_GT(std::fabs(here / scaled_bessels(60, 60)[60] - 1), 0.1);
}

}  // namespace
}  // namespace straytrace
