// SPDX-License-Identifier: BSD-3-Clause
// Total of a GGX surface of small mirrors with Smith's shadowing (microfacet.hpp, grooves.hpp), and how it is tabled.
// What the energy balance calls absorbed is 1 - total, so it must be what the samples average to.
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"

namespace straytrace {

struct Facets {
  double across = 1, along = 1;  // widths of the normals
  double reflectance = 0, grazing = 0;
};

// Integral of eval cos over the hemisphere, wi.z > 0, never above the larger reflectance. step: of the quadrature;
// the default leaves 1e-7.
double facets_total(Facets const&, Vec3 wi, double step = 0.14);

// From 0 (v = 0) to 1 (v = most): half even in v, half in its logarithm above 1, crowded at 0.
STRAY_HD double crowded(double v, double most) {
  double const x = log_positive(v + std::sqrt(v * v + 1)) / log_positive(most + std::sqrt(most * most + 1));
  double const y = 0.5 * (x + v / most);
  return std::sqrt(y < 1 ? y : 1);
}
double uncrowded(double x, double most);  // host

// Lagrange's polynomial through six of `size` nodes even over 0 to 1.
struct Stencil {
  static constexpr int points = 6;
  int first;
  double weight[points];

  STRAY_HD Stencil(double x, int size) {
    x *= size - 1;
    int const left = static_cast<int>(x) - 2;
    first = left < 0 ? 0 : left > size - points ? size - points : left;
    constexpr double scale[points] = {-1.0 / 120, 1.0 / 24, -1.0 / 12, 1.0 / 12, -1.0 / 24, 1.0 / 120};
    for (int i = 0; i < points; ++i) {
      weight[i] = scale[i];
      for (int k = 0; k < points; ++k)
        if (k != i) weight[i] *= x - (first + k);
    }
  }
  STRAY_HD double of(double const* value) const {
    double sum = 0;
    for (int i = 0; i < points; ++i) sum += weight[i] * value[first + i];
    return sum;
  }
};

}  // namespace straytrace
