// SPDX-License-Identifier: BSD-3-Clause
#include "optics/power_law.hpp"

#include <cmath>

#include "optics/lobe_prepare.hpp"

namespace straytrace {
namespace {

// Ci(t) - gamma - ln(t) as its power series, for t up to pi.
double cosine_integral_series(double t) {
  double term = 1, sum = 0;
  for (int n = 2; n <= 40; n += 2) {
    term *= -t * t / ((n - 1) * n);
    sum += term / n;
  }
  return sum;
}

}  // namespace

void PowerLaw::prepare() { lobe.prepare(*this, above, 2 * sincos_turn(above / (4 * pi)).sin * (1 - 1e-12)); }

double statistical_integral(double a, double b) {
  return std::sin(a) / a - std::sin(b) / b + std::log(b / a) + cosine_integral_series(b) - cosine_integral_series(a);
}

double statistical_kappa(double above) { return 1 / statistical_integral(above, pi / 2); }

}  // namespace straytrace
