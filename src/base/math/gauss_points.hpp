// SPDX-License-Identifier: BSD-3-Clause
// Gauss-Legendre quadrature. Without libm, so that tables made with it have the same bits everywhere.
#pragma once

#include <vector>

#include "base/math/functions.hpp"

namespace straytrace {

// Gauss-Legendre points and weights on [0, 1].
struct GaussPoints {
  std::vector<double> at, weight;
  explicit GaussPoints(int size) {
    for (int i = 0; i < size; ++i) {
      double x = sincos_turn((i + 0.75) / (2 * size + 1)).cos, slope = 1;
      for (int step = 0; step < 50; ++step) {
        double p = 1, before = 0;
        for (int n = 1; n <= size; ++n) {
          double const next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
          before = p;
          p = next;
        }
        slope = size * (x * p - before) / (x * x - 1);
        double const known = x;
        x -= p / slope;
        if (x == known) break;
      }
      at.push_back(0.5 * (1 - x));
      weight.push_back(1 / ((1 - x * x) * slope * slope));
    }
  }
};

}  // namespace straytrace
