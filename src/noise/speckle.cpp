// SPDX-License-Identifier: BSD-3-Clause
#include "noise/speckle.hpp"

#include <cmath>

namespace straytrace {

double speckle_percentile(double below) { return -std::log1p(-below); }

double quadrature_percentile(double below) {
  double x = 1;  // erf(x) = below by Newton steps; chi-square of one degree of freedom is 2 x^2
  for (int i = 0; i < 60; ++i) x += (std::erfc(x) - (1 - below)) * 0.886226925452758 * std::exp(x * x);
  return 2 * x * x;
}

}  // namespace straytrace
