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

// exp(-x) I_n(x) for n = 0 to `most` at any x >= 0, to 1e-9. The ratios of neighbours follow from those of higher
// orders by the stable, downward recurrence; the highest lies between the bounds of Amos, (n + 1)/x^2 of itself apart.
inline std::vector<double> scaled_bessels(int most, double x) {
  std::vector<double> values(std::size_t(most) + 1);
  int n = most + 20 + int(std::fmin(std::ceil(std::sqrt(40 * x)), 1000.0));
  double ratio = x / (n - 0.5 + std::hypot(n, x));  // I_n over I_(n-1)
  while (--n > 0) {
    ratio = x / (2 * n + x * ratio);
    if (n <= most) values[std::size_t(n)] = ratio;
  }
  values[0] = scaled_bessel(0, x);
  for (std::size_t i = 1; i < values.size(); ++i) values[i] *= values[i - 1];
  return values;
}

}  // namespace straytrace
