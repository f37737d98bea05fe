// SPDX-License-Identifier: BSD-3-Clause
#include "trace/importance/law_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace straytrace {
namespace {

constexpr int choices = 8;
constexpr double weight_of_parts = 0.25;  // measured: more costs enclosures, less gains nothing elsewhere
using PerChoice = std::array<double, choices>;

struct Sums {  // of one goal over one part of the scene
  double first = 0;
  PerChoice second{};
};

// The least, and steps from there towards the law.
PerChoice shares_from(double least) {
  constexpr double step = 0.65;
  PerChoice shares;
  double aimed = 1 - least;
  for (double& share : shares) {
    share = std::max(least, 1 - aimed);
    aimed *= step;
  }
  return shares;
}

}  // namespace

double best_law_share(Arriving const& arriving, double emitted, std::vector<Target> const& targets,
                      std::vector<Worth> const& worths, std::size_t side, std::vector<std::uint32_t> const& part_of,
                      double least) {
  std::vector<double> aimed(part_of.size(), 0);
  for (Target const& t : targets) aimed[t.patch] = t.share;
  double all = 0;
  for (double const share : arriving.share) all += share;
  double const unit = std::max(all, emitted);
  std::size_t const parts = *std::max_element(part_of.begin(), part_of.end()) + 1;
  std::vector<Sums> of_part(parts);
  PerChoice const choice = shares_from(least);
  PerChoice cost{};
  for (Worth const& worth : worths) {
    std::fill(of_part.begin(), of_part.end(), Sums{});
    for (std::size_t i = 0; i < arriving.share.size(); ++i) {
      double const f = arriving.share[i] / unit, a = worth.adjoint[i];
      if (!(f * a > 0)) continue;
      double const peak = arriving.peak[i] / unit;
      Sums& sums = of_part[part_of[i / 2]];
      sums.first += f * a;
      for (int k = 0; k < choices; ++k)
        sums.second[k] += f * peak * a * a / (choice[k] * peak + (1 - choice[k]) * aimed[i / 2]);
    }
    Sums whole;
    double lit_parts = 0;
    for (Sums const& part : of_part) {
      if (!(part.first > 0)) continue;
      ++lit_parts;
      whole.first += part.first;
      for (int k = 0; k < choices; ++k) whole.second[k] += part.second[k];
    }
    if (!(whole.first > 0)) continue;
    for (int k = 0; k < choices; ++k) {
      double const over = std::max(whole.second[k] / (whole.first * whole.first) - 1, 0.0);
      cost[k] += std::log(1 + worth.hops[side] * over);
      for (Sums const& part : of_part)
        if (part.first > 0)
          cost[k] += weight_of_parts / lit_parts * std::log(part.second[k] / (part.first * part.first));
    }
  }
  return choice[std::size_t(std::min_element(cost.begin(), cost.end()) - cost.begin())];
}

}  // namespace straytrace
