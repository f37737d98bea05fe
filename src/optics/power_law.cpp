// SPDX-License-Identifier: BSD-3-Clause
#include "optics/power_law.hpp"

#include <cmath>

namespace straytrace {
namespace {

// Integral over azimuth of max(0, a + b cos(phi)), b >= 0: the cosine of scatter around a tilted specular direction.
double azimuth_integral(double a, double b) {
  if (a >= b) return 2 * pi * a;
  if (a <= -b) return 0;
  double const edge = std::acos(-a / b);
  return 2 * (a * edge + b * std::sin(edge));
}

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

void PowerLaw::prepare() {
  total = integral(pi);
  constexpr int steps = 2048;  // Simpson's rule in ln(theta)
  double const span = std::log(pi / above);
  for (int i = 0; i < AlbedoTable::size; ++i) {
    double const cos_i = AlbedoTable::cosine(i), sin_i = std::sqrt(1 - cos_i * cos_i);
    double sum = 0;
    for (int j = 0; j <= steps; ++j) {
      double const theta = above * std::exp(span * j / steps);
      double const ring = azimuth_integral(std::cos(theta) * cos_i, std::sin(theta) * sin_i);
      double const weight = j == 0 || j == steps ? 1 : j % 2 ? 4 : 2;
      sum += weight * kappa * std::pow(theta, 1 - exponent) * std::sin(theta) * ring;
    }
    table.value[i] = sum * span / steps / 3;
  }
}

double statistical_integral(double a, double b) {
  return std::sin(a) / a - std::sin(b) / b + std::log(b / a) + cosine_integral_series(b) - cosine_integral_series(a);
}

double statistical_kappa(double above) { return 1 / statistical_integral(above, pi / 2); }

}  // namespace straytrace
