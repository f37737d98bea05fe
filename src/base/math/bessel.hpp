// SPDX-License-Identifier: BSD-3-Clause
// Bessel functions where those of the standard library overflow.
#pragma once

#include <cmath>
#include <vector>

#include "base/math/constants.hpp"
#include "base/namespaces.hpp"

namespace straytrace {

// exp(-x) I_n(x), n = 0 or 1, at any x >= 0: the asymptotic series where it reaches rounding.
inline double scaled_bessel(int n, double x) {
  if (x < 50) return std::exp(-x) * std::cyl_bessel_i(double(n), x);
  double term = 1, sum = 1;
  for (int j = 1; j < 100 && std::fabs(term) > 1e-17; ++j) {
    term *= ((2 * j - 1) * (2 * j - 1) - 4 * n * n) / (8 * j * x);
    sum += term;
  }
  return sum / std::sqrt(2 * pi * x);
}

// exp(-x) I_n(x) for n = 0 to `most`, 30 at most, at any x >= 0.
inline std::vector<double> scaled_bessels(int most, double x) {
  std::vector<double> values;
  for (int n = 0; n <= most; ++n)
    // Upward recurrence loses digits only where I_n is far below I_0.
    values.push_back(n < 2    ? scaled_bessel(n, x)
                     : x < 50 ? std::exp(-x) * std::cyl_bessel_i(double(n), x)
                              : values[std::size_t(n) - 2] - 2 * (n - 1) / x * values[std::size_t(n) - 1]);
  return values;
}

}  // namespace straytrace
