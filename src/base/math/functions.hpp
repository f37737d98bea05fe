// SPDX-License-Identifier: BSD-3-Clause
// Elementary functions with the same bits on every processor: libm picks different kernels on different machines.
// Errors stay within a few units in the last place over the ranges the trace uses, those of power_positive within
// 3 + 1.6 |exponent ln(base)| (tests/unit/base/functions.cpp).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/math/constants.hpp"
#include "base/math/vec3.hpp"

namespace straytrace {

struct SinCos {
  double sin, cos;
};

STRAY_HD std::uint64_t bits_of(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
STRAY_HD double number_of(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

// sin and cos of 2 pi turns, |turns| < 2^60. Without branches, because the quadrant of a random angle is unpredictable.
// NaN gives NaN.
STRAY_NO_CHECK("float-cast-overflow") STRAY_HD SinCos sincos_turn(double turns) {
  double const shifted = 4 * turns + 0.5;
  auto quarter = static_cast<std::int64_t>(shifted);
  quarter -= static_cast<double>(quarter) > shifted;  // floor
  double const x = 2 * pi * (turns - 0.25 * static_cast<double>(quarter)), y = x * x;
  double s = -1.0 / 1307674368000;
  s = s * y + 1.0 / 6227020800;
  s = s * y - 1.0 / 39916800;
  s = s * y + 1.0 / 362880;
  s = s * y - 1.0 / 5040;
  s = s * y + 1.0 / 120;
  s = s * y - 1.0 / 6;
  s = x + x * y * s;
  double c = 1.0 / 20922789888000;
  c = c * y - 1.0 / 87178291200;
  c = c * y + 1.0 / 479001600;
  c = c * y - 1.0 / 3628800;
  c = c * y + 1.0 / 40320;
  c = c * y - 1.0 / 720;
  c = c * y + 1.0 / 24;
  c = c * y - 0.5;
  c = 1 + y * c;
  // Odd quarters swap the two; the sine changes sign in quarters 2 and 3, the cosine in 1 and 2.
  auto const q = static_cast<std::uint64_t>(quarter);
  std::uint64_t const sine = bits_of(s), cosine = bits_of(c), swap = (sine ^ cosine) & (0 - (q & 1));
  return {number_of((sine ^ swap) ^ (q & 2) << 62), number_of((cosine ^ swap) ^ ((q + 1) & 2) << 62)};
}

// Natural logarithm of a positive, normal number.
STRAY_HD double log_positive(double x) {
  std::uint64_t const bits = bits_of(x);
  auto exponent = static_cast<std::int64_t>(bits >> 52) - 1023;
  double m = number_of((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  double const f = (m - 1) / (m + 1), y = f * f;
  double p = 1.0 / 21;
  for (int n = 19; n >= 3; n -= 2) p = p * y + 1.0 / n;
  double const e = static_cast<double>(exponent);
  return e * 0.6931471803691238 + (2 * f + (2 * f * y * p + e * 1.9082149292705877e-10));
}

STRAY_HD double exp_number(double x) {
  if (x < -708) return 0;
  if (x > 709) return infinity;
  double const k = std::floor(x * 1.4426950408889634 + 0.5);
  double const r = (x - k * 0.6931471803691238) - k * 1.9082149292705877e-10;
  double p = 1.0 / 14;
  for (int n = 13; n >= 1; --n) p = (1 + r * p) / n;
  return number_of(static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023) << 52) * (1 + r * p);
}

STRAY_HD double power_positive(double base, double exponent) { return exp_number(exponent * log_positive(base)); }

// atan of a non-negative number.
STRAY_HD double atan_positive(double x) {
  bool const inverse = x > 1;
  if (inverse) x = 1 / x;
  x /= 1 + std::sqrt(1 + x * x);
  x /= 1 + std::sqrt(1 + x * x);
  double const y = x * x;
  double p = 0;
  for (int n = 25; n >= 3; n -= 2) p = y * (1.0 / n - p);
  double const angle = 4 * x * (1 - p);
  return inverse ? pi / 2 - angle : angle;
}

// Azimuth of the point (x, y) in turns, from 0 to 1; 0 at the origin.
STRAY_HD double turn_of(double x, double y) {
  double const a = std::fabs(x), b = std::fabs(y);
  if (a == 0 && b == 0) return 0;
  double const eighth = b <= a ? atan_positive(b / a) / (2 * pi) : 0.25 - atan_positive(a / b) / (2 * pi);
  double const half = x < 0 ? 0.5 - eighth : eighth;
  return y < 0 ? 1 - half : half;
}

// Angle between two unit vectors, exact to rounding for small angles too.
STRAY_HD double angle_between(Vec3 a, Vec3 b) {
  double const sum = length(a + b);
  return sum > 0 ? 2 * atan_positive(length(a - b) / sum) : pi;
}

}  // namespace straytrace
