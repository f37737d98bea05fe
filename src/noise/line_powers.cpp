// SPDX-License-Identifier: BSD-3-Clause
#include "noise/line_powers.hpp"

namespace straytrace {

std::vector<double> const& LinePowers::at(Spectrum const& s, double spacing, std::size_t count) {
  if (spacing != spacing_) power_.assign(1, 0);
  spacing_ = spacing;
  for (std::size_t k = power_.size(); k < count; ++k) {
    double const line = static_cast<double>(k);
    power_.push_back(s.power((line - 0.5) * spacing, (line + 0.5) * spacing));
  }
  return power_;
}

}  // namespace straytrace
