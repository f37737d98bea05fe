// SPDX-License-Identifier: BSD-3-Clause
// Variance and percentiles of samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace straytrace {

// Of the population that they are from; two at least.
inline double sample_variance(std::span<double const> values) {
  auto const n = static_cast<double>(values.size());
  double const mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum = 0;
  for (double x : values) sum += (x - mean) * (x - mean);
  return sum / (n - 1);
}

// The smallest value that at least this share of the values, 0 < share <= 1, does not exceed. With fewer than 20
// values, percentiles 5 and 95 are the smallest and the largest.
inline double nearest_rank(std::vector<double> const& ascending, double share) {
  double const rank = std::ceil(share * double(ascending.size()) * (1 - 1e-12));
  return ascending[std::size_t(std::max(rank, 1.0)) - 1];
}

}  // namespace straytrace
