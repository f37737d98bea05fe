// SPDX-License-Identifier: BSD-3-Clause
#include "optics/abg.hpp"

#include <cmath>

namespace straytrace {
namespace {

// Integral of the law over the part of the unit circle of direction cosines between radii low and high about the
// specular point, which lies at `centre`; midpoint rule in the square of the radius. Up to 1 - centre the circles are
// whole, beyond they are cut by the horizon.
double ring_power(Abg const& law, double low, double high, double centre) {
  if (!(low < high)) return 0;
  constexpr int steps = 64;
  double const first = low * low, step = (high * high - first) / steps;
  double sum = 0;
  for (int j = 0; j < steps; ++j) {
    double const rho2 = first + (j + 0.5) * step, rho = std::sqrt(rho2);
    bool const whole = high <= 1 - centre;
    sum += law.value(rho) * (whole ? 1 : std::acos((rho2 + centre * centre - 1) / (2 * rho * centre)) / pi);
  }
  return pi * step * sum;
}

}  // namespace

void Abg::prepare() {
  double const knee = std::fmin(b > 0 ? std::pow(b, 1 / g) : 1e-6, 1.0);
  double const first = 1e-2 * knee;
  edge[0] = 0;
  for (int i = 1; i <= rings; ++i) edge[i] = first * std::pow(2 / first, (i - 1.0) / (rings - 1));
  edge[rings] = 2 * (1 + 1e-15);  // opposite grazing directions are just inside
  cumulative[0] = 0;
  for (int i = 0; i < rings; ++i) {
    double const middle = std::sqrt(0.5 * (edge[i] * edge[i] + edge[i + 1] * edge[i + 1]));
    cumulative[i + 1] = cumulative[i] + value(middle) * (edge[i + 1] * edge[i + 1] - edge[i] * edge[i]);
  }
  double const total = cumulative[rings];
  for (double& c : cumulative) c /= total;
  cumulative[rings] = 1;

  for (int k = 0; k < AlbedoTable::size; ++k) {
    double const cos_i = AlbedoTable::cosine(k), centre = std::sqrt(1 - cos_i * cos_i);
    double const whole = 1 - centre, last = 1 + centre;
    double sum = 0;
    for (int i = 0; i < rings; ++i)
      sum += ring_power(*this, edge[i], std::fmin(edge[i + 1], whole), centre) +
             ring_power(*this, std::fmax(edge[i], whole), std::fmin(edge[i + 1], last), centre);
    table.value[k] = sum;
  }
}

}  // namespace straytrace
