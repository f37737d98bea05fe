// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "report/band.hpp"

namespace straytrace {

std::string regime(NoiseTrace const& t, FrequencyGrid const& grid, double low, double high) {
  if (!(t.mean_square_phase > 0)) return "-";
  double changed_at = 0;
  int bins = 0, changes = 0;
  bool linear = false;
  for (std::size_t i = 0; i < t.linear_share.size(); ++i) {
    if (grid.centre(i) < low || grid.centre(i) > high || std::isnan(t.linear_share[i])) continue;
    bool const now = t.linear_share[i] >= 0.5;
    if (bins++ > 0 && now != linear) {
      ++changes;
      changed_at = grid.edges[i];
    }
    linear = now;
  }
  if (bins == 0) return t.mean_square_phase > wrapped_from * wrapped_from ? "wrapped" : "linear";
  if (changes == 0) return linear ? "linear" : "wrapped";
  return changes == 1 ? fmt::format("linear {} {:.3g} Hz", linear ? ">" : "<", changed_at) : "mixed";
}

}  // namespace straytrace
