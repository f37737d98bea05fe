// SPDX-License-Identifier: BSD-3-Clause
// A cavity in which nothing is symmetric, and how far fields are apart.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/every_module.hpp"
#include "wave/cavity.hpp"

namespace straytrace::testing {

// Off-centre rims, legs of different lengths, mirrors that tilt.
inline WaveCavity uneven_cavity(int points) {
  WaveCavity cavity{1064e-9, 1000, {}, {}, {}, {points, 0.4}};
  cavity.mirror1 = {1 / 2500.0, {0.05}, 1e-7, -2e-7, {}, 1e-4};
  cavity.mirror2 = {1 / 2500.0, {0.06, 0.001}, 0, 1e-7, {}, 2e-4};
  cavity.baffles = {{300, {0.05, 0.004, -0.003}}, {420, {0.045}}, {900, {0.06, 0, 0.002}}};
  return cavity;
}

// Relative to the largest value.
inline double distance_of(Field const& a, Field const& b) {
  double most = 0, largest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    most = std::max(most, std::abs(a.values[i] - b.values[i]));
    largest = std::max(largest, std::abs(b.values[i]));
  }
  return most / largest;
}

}  // namespace straytrace::testing
