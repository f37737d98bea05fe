// SPDX-License-Identifier: BSD-3-Clause
// Percentiles of draws by nearest rank: each is the value of one draw.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace straytrace {

// The smallest value that at least this share of the values, 0 < share <= 1, does not exceed. With fewer than 20
// values, percentiles 5 and 95 are the smallest and the largest.
inline double nearest_rank(std::vector<double> const& ascending, double share) {
  double const rank = std::ceil(share * double(ascending.size()) * (1 - 1e-12));
  return ascending[std::size_t(std::max(rank, 1.0)) - 1];
}

}  // namespace straytrace
