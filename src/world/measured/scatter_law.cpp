// SPDX-License-Identifier: BSD-3-Clause
#include "world/measured/scatter_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "world/measured/text_tokens.hpp"

namespace straytrace {

void check_scatter_points(std::vector<ScatterPoint> const& points, std::vector<Problem>& problems) {
  auto const groups = by_incidence(points);
  for (auto const& group : groups) {
    auto const [low, high] = std::minmax_element(group.begin(), group.end(),
                                                 [](auto const& a, auto const& b) { return a.offset < b.offset; });
    if (high->offset < 1.5 * low->offset || high->offset < 1e-6)
      complain(
          problems, {},
          fmt::format("the points at {:.4g} deg of incidence cover no range of angles", group[0].theta_i * 180 / pi),
          "measure several angles of scatter for each incidence, or leave this one out");
  }
}

Measured law_of_points(std::vector<ScatterPoint> const& points, std::string_view beyond, MeasuredSummary& summary) {
  std::vector<MeasuredPoint> all;
  for (ScatterPoint const& p : points) all.push_back({std::sin(p.theta_i), p.offset, p.value});
  Measured law;
  summary = fit_measured(law, all,
                         beyond == "constant" ? Beyond::constant
                         : beyond == "power"  ? Beyond::power
                                              : Beyond::zero);
  return law;
}

}  // namespace straytrace
