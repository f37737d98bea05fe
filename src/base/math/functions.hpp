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
#include "base/memory/host_device.hpp"

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

// Polynomials of degree 3, 5 and 7 by Estrin's scheme: short chains of dependent operations.
STRAY_HD double cubic(double x, double x2, double c0, double c1, double c2, double c3) {
  return (c0 + c1 * x) + x2 * (c2 + c3 * x);
}
STRAY_HD double quintic(double x, double x2, double c0, double c1, double c2, double c3, double c4, double c5) {
  return cubic(x, x2, c0, c1, c2, c3) + (x2 * x2) * (c4 + c5 * x);
}
STRAY_HD double septic(double x, double x2, double c0, double c1, double c2, double c3, double c4, double c5, double c6,
                       double c7) {
  return cubic(x, x2, c0, c1, c2, c3) + (x2 * x2) * cubic(x, x2, c4, c5, c6, c7);
}

// Adding it rounds a number below 2^51 to the nearest integer, which is then in the lowest bits.
constexpr double to_integer = 0x1.8p52;

// sin and cos of 2 pi turns, |turns| < 2^49. Without branches, because the quadrant of a random angle is unpredictable.
// NaN gives NaN. Minimax polynomials on an eighth of a turn, errors 4e-18 and 5e-20.
STRAY_HD SinCos sincos_turn(double turns) {
  double const shifted = 4 * turns + to_integer, quarter = shifted - to_integer;
  double const x = 2 * pi * (turns - 0.25 * quarter), y = x * x, y2 = y * y;
  double const s = x + (x * y) * quintic(y, y2, -0.16666666666666632, 0.00833333333332242, -0.00019841269829812627,
                                         2.7557313693640902e-06, -2.5050758393329112e-08, 1.58968122475868e-10);
  double const c = 1 + (y2 * quintic(y, y2, 0.0416666666666666, -0.0013888888888874133, 2.4801587289487663e-05,
                                     -2.75573143539398e-07, 2.087572349569123e-09, -1.1359659551353221e-11) -
                        0.5 * y);
  // Odd quarters swap the two; the sine changes sign in quarters 2 and 3, the cosine in 1 and 2.
  std::uint64_t const q = bits_of(shifted);
  std::uint64_t const sine = bits_of(s), cosine = bits_of(c), swap = (sine ^ cosine) & (0 - (q & 1));
  return {number_of((sine ^ swap) ^ (q & 2) << 62), number_of((cosine ^ swap) ^ ((q + 1) & 2) << 62)};
}

// Natural logarithm of a positive, normal number m 2^e, m from sqrt(1/2) to sqrt(2): 2 atanh((m - 1)/(m + 1)) with a
// minimax polynomial, error 1e-18.
STRAY_HD double log_positive(double x) {
  std::uint64_t const bits = bits_of(x), above = bits - 0x3fe6a09e667f3bcdull;
  double const m = number_of(bits - (above & 0xfff0000000000000ull));
  double const e = static_cast<double>(static_cast<std::int64_t>(above) >> 52);
  double const f = (m - 1) / (m + 1), y = f * f, y2 = y * y;
  double const p = cubic(y, y2, 0.3333333333333367, 0.19999999999707177, 0.1428571437123479, 0.11111099281978531) +
                   (y2 * y2) * ((0.09091782422272816 + 0.07657018177457939 * y) + y2 * 0.07398050319347795);
  return e * 0.6931471803691238 + (2 * f + (2 * f * y * p + e * 1.9082149292705877e-10));
}

// exp(k log 2 + r) = 2^k exp(r), |r| < log(2)/2, with a minimax polynomial, error 4e-18.
STRAY_HD double exp_number(double x) {
  if (x < -708) return 0;
  if (x > 709) return infinity;
  double const shifted = x * 1.4426950408889634 + to_integer, k = shifted - to_integer;
  double const r = (x - k * 0.6931471803691238) - k * 1.9082149292705877e-10, r2 = r * r, r4 = r2 * r2;
  double const p =
      septic(r, r2, 0.5000000000000011, 0.16666666666666413, 0.041666666666530155, 0.00833333333349447,
             0.0013888888943630361, 0.00019841269506555356, 2.4801493098733352e-05, 2.755758639674158e-06) +
      (r4 * r4) * (2.763024842243285e-07 + 2.5000053878886233e-08 * r);
  return number_of((bits_of(shifted) + 1023) << 52) * (1 + (r + r2 * p));
}

STRAY_HD double power_positive(double base, double exponent) { return exp_number(exponent * log_positive(base)); }

// atan(y/x) for numbers that are not negative, not both 0: 0 to pi/2. The quotient is turned by 0, pi/4 or pi/2 to
// below tan(pi/8); a minimax polynomial, error 1e-18.
STRAY_HD double atan_ratio(double y, double x) {
  constexpr double eighth = 0.41421356237309503, three_eighths = 2.414213562373095;  // tan(pi/8), tan(3 pi/8)
  bool const near = y <= eighth * x, far = y > three_eighths * x;
  double const turned = near  ? 0
                        : far ? 1.5707963267948966
                              : 0.7853981633974483,
               rest = near  ? 0
                      : far ? 6.123233995736766e-17
                            : 3.061616997868383e-17;
  double const t = (near ? y : far ? -x : y - x) / (near ? x : far ? y : y + x), z = t * t, z2 = z * z, z4 = z2 * z2;
  double const p = septic(z, z2, -0.333333333333332, 0.1999999999995405, -0.14285714280244685, 0.11111110785931512,
                          -0.0909089783015922, 0.07692061519802099, -0.06663118996032359, 0.058479984630972245) +
                   (z4 * z4) * ((-0.050397969575128945 + 0.038077053392246075 * z) + z2 * -0.017920856676370417);
  return turned + (t + (t * z * p + rest));
}

// atan of a number that is not negative.
STRAY_HD double atan_positive(double x) { return atan_ratio(x, 1); }

// Azimuth of the point (x, y) in turns, from 0 to 1; 0 at the origin.
STRAY_HD double turn_of(double x, double y) {
  double const a = std::fabs(x), b = std::fabs(y);
  if (a == 0 && b == 0) return 0;
  double const eighth = atan_ratio(b, a) / (2 * pi);
  double const half = x < 0 ? 0.5 - eighth : eighth;
  return y < 0 ? 1 - half : half;
}

// Angle between two unit vectors, exact to rounding for small angles too.
STRAY_HD double angle_between(Vec3 a, Vec3 b) { return 2 * atan_ratio(length(a - b), length(a + b)); }

// Square of the angle whose chord has this square, t2 = (2 sin(angle/2))^2 <= 4.
STRAY_HD double angle2_of_chord2(double t2) {
  double const z = 0.25 * t2;  // asin(sqrt(z))^2 = z (1 + z/3 + ...)
  if (z <= 0.125) {
    double const z2 = z * z, z4 = z2 * z2;
    double const p = septic(z, z2, 0.33333333333333026, 0.17777777777896592, 0.11428571412751799, 0.08126985168269502,
                            0.061567668735371034, 0.048722321820443906, 0.03964764852684625, 0.034542486696724425) +
                     (z4 * z4) * (0.021234365721986552 + 0.046143417923387685 * z);
    return t2 + t2 * (z * p);
  }
  double const angle = 2 * atan_ratio(std::sqrt(z), std::sqrt(z < 1 ? 1 - z : 0));
  return angle * angle;
}

// Binary search, for hosts and devices.

// The first index from `low` to `end` - 1 for which `holds`, which is false up to it and true from it on; else `end`.
// `low` where that is not below `end`. The number of steps depends on that of the indices alone and no step branches:
// what is searched for is mostly random.
template <class Holds>
STRAY_HD std::uint32_t first_where(std::uint32_t low, std::uint32_t end, Holds const& holds) {
  for (std::uint32_t left = low < end ? end - low : 0; left > 0;) {
    std::uint32_t const half = (left + 1) / 2;
    low += holds(low + half - 1) ? 0 : half;
    left -= half;
  }
  return low;
}

}  // namespace straytrace
