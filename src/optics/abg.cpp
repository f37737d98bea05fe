// SPDX-License-Identifier: BSD-3-Clause
#include "optics/abg.hpp"

#include <cmath>

namespace straytrace {
namespace {

// Share of the circle of radius `rho` about a point at distance `centre` < 1 that lies inside the unit circle.
double share_inside(double rho, double centre) {
  if (rho + centre <= 1) return 1;
  if (rho - centre >= 1) return 0;
  return std::acos((rho * rho + centre * centre - 1) / (2 * rho * centre)) / pi;
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

  constexpr int steps = 64;  // midpoint rule per ring, in the square of the offset
  for (int k = 0; k < AlbedoTable::size; ++k) {
    double const cos_i = double(k) / (AlbedoTable::size - 1), centre = std::sqrt(1 - cos_i * cos_i);
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
      double const low = edge[i] * edge[i], step = (edge[i + 1] * edge[i + 1] - low) / steps;
      for (int j = 0; j < steps; ++j) {
        double const rho = std::sqrt(low + (j + 0.5) * step);
        sum += pi * step * value(rho) * share_inside(rho, centre);
      }
    }
    table.value[k] = sum;
  }
}

}  // namespace straytrace
