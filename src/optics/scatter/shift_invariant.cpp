// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/shift_invariant.hpp"

#include <cmath>

#include "optics/lobes/lobe_prepare.hpp"

namespace straytrace {

void Abg::prepare() { lobe.prepare(*this, b > 0 ? power_positive(b, 1 / std::fmax(g, 0.1)) : 1e-6); }

void Gaussian::prepare() { lobe.prepare(*this, width); }

void Harvey::prepare() { lobe.prepare(*this, across > 0 ? std::fmin(width, across) : width); }

double Harvey::tis() const {
  double const l2 = width * width;
  if (std::fabs(slope + 2) < 1e-9) return pi * b0 * l2 * std::log1p(1 / l2);
  return 2 * pi * b0 * l2 * std::expm1((slope + 2) / 2 * std::log1p(1 / l2)) / (slope + 2);
}

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
