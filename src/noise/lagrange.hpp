// SPDX-License-Identifier: BSD-3-Clause
// Interpolation on a lattice of constant step.
#pragma once

#include <array>

namespace straytrace {

// Lagrange polynomials of the points -m...m at x; m <= 4.
inline std::array<double, 9> lagrange(double x, int m) {
  std::array<double, 9> out{};
  int const n = 2 * m + 1;
  std::array<double, 10> left{};
  left[0] = 1;
  for (int k = 0; k < n; ++k) left[k + 1] = left[k] * (x - (k - m));
  double right = 1;
  for (int k = n; k-- > 0;) {
    double denominator = 1;
    for (int j = 1; j <= k; ++j) denominator *= j;
    for (int j = 1; j < n - k; ++j) denominator *= -j;
    out[k] = left[k] * right / denominator;
    right *= x - (k - m);
  }
  return out;
}

}  // namespace straytrace
