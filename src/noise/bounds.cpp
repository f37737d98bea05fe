// SPDX-License-Identifier: BSD-3-Clause
// Which curves are upper bounds (docs/theory/diffraction.md, eq. 8.11: rims as one smooth wave; speckle lowers that).
#include <algorithm>

#include "noise/noise.hpp"

namespace straytrace {

void find_bounds(NoiseBudget& b, CouplingTable const& table) {
  std::size_t const bins = b.grid.size();
  std::vector<double> bound(bins);
  for (std::size_t r = 0; r < b.routes.size() && r < table.classes.size(); ++r) {
    NoiseTrace& t = b.routes[r];
    t.upper_bound = table.classes[r].kind == ClassKind::edge;
    for (std::size_t i = 0; t.upper_bound && i < bins; ++i) bound[i] += t.asd[i] * t.asd[i];
  }
  b.total.bound_share.clear();
  for (std::size_t i = 0; i < bins; ++i) {
    double const all = b.total.asd[i] * b.total.asd[i];
    b.total.bound_share.push_back(all > 0 ? std::min(bound[i] / all, 1.0) : 0);
  }
}

}  // namespace straytrace
