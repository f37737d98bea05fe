// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <map>

#include "trace/importance/steering_tables.hpp"

namespace straytrace::trace {

namespace {

// Adds the effort for one goal: half by worth; half evenly over the bodies, and over the groups of each, that are worth
// anything, since a faint part of the scene may be the one that moves.
void add_goal(std::vector<double>& effort, std::vector<double> const& worth, Parts const& parts) {
  std::vector<double> of_part(parts.body.size(), 0);
  double total = 0;
  for (std::size_t i = 0; i < worth.size();) {  // neighbours often belong to one part
    std::uint32_t const part = parts.of_patch[i];
    double sum = of_part[part];
    for (; i < worth.size() && parts.of_patch[i] == part; ++i) {
      sum += worth[i];
      total += worth[i];
    }
    of_part[part] = sum;
  }
  std::vector<double> groups(parts.bodies, 0);  // per body
  double bodies = 0;
  for (std::size_t k = 0; k < of_part.size(); ++k)
    if (of_part[k] > 0 && groups[parts.body[k]]++ == 0) ++bodies;
  std::vector<double> share(of_part.size(), 0);  // per unit of worth
  for (std::size_t k = 0; k < of_part.size(); ++k)
    if (of_part[k] > 0) share[k] = 0.5 / total + 0.5 / (bodies * groups[parts.body[k]] * of_part[k]);
  for (std::size_t i = 0; i < worth.size(); ++i) effort[i] += share[parts.of_patch[i]] * worth[i];
}

}  // namespace

Parts parts_of(World const& world, SteeringTables const& tables) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  Parts parts;
  std::map<std::uint32_t, std::uint32_t> bodies;
  for (Patch const& p : tables.patches) {  // represented by its first strip
    SurfaceId const id = tables.strips[tables.members[p.first].strip].surface;
    Surface const& surface = world.surfaces()[id.value];
    auto const [at, added] =
        numbers.emplace(std::pair{surface.body.value, surface.group.value}, std::uint32_t(numbers.size()));
    if (added) parts.body.push_back(bodies.emplace(surface.body.value, std::uint32_t(bodies.size())).first->second);
    parts.of_patch.push_back(at->second);
  }
  parts.bodies = bodies.size();
  return parts;
}

std::vector<double> efforts_of(Parts const& parts, Arriving const& arriving, std::vector<Worth> const& worths,
                               double unseen) {
  if (arriving.empty()) return {};
  std::size_t const patches = parts.of_patch.size();
  std::vector<double> effort(patches, 0), worth(patches);
  for (auto const& [adjoint, hops] : worths) {
    for (std::size_t i = 0; i < patches; ++i)
      worth[i] =
          arriving.possible(2 * i, unseen) * adjoint[2 * i] + arriving.possible(2 * i + 1, unseen) * adjoint[2 * i + 1];
    add_goal(effort, worth, parts);
  }
  double total = 0;
  for (double const e : effort) total += e;
  if (!(total > 0)) return {};
  double const unit = 1 / total;
  for (double& e : effort) e *= unit;
  return effort;
}

namespace {

// The k-th largest of numbers from 0 to 1, k >= 1. Floating-point numbers have the order of their bits: counts by the
// upper ones, 16 in each octave, leave few numbers to compare.
double kth_largest(std::vector<double> const& numbers, std::size_t k) {
  constexpr int lower_bits = 48;
  auto const upper = [](double x) { return std::bit_cast<std::uint64_t>(x) >> lower_bits; };
  std::array<std::uint32_t, 1024> counts{};  // from 1 downwards; the last one is that of all smaller numbers
  auto const place = [&](double x) { return std::min<std::uint64_t>(upper(1.0) - upper(x), counts.size() - 1); };
  for (double const x : numbers) ++counts[place(x)];
  std::size_t at = 0, larger = 0;
  while (larger + counts[at] < k) larger += counts[at++];
  std::vector<double> rest;
  for (double const x : numbers)
    if (place(x) == at) rest.push_back(x);
  auto const found = rest.begin() + std::ptrdiff_t(k - larger) - 1;
  std::nth_element(rest.begin(), found, rest.end(), std::greater<>());
  return *found;
}

}  // namespace

std::vector<Target> targets_of(std::vector<double> const& efforts, std::size_t most) {
  double const least = efforts.size() > most ? kth_largest(efforts, most) : 0;  // of the last one that still counts
  std::vector<Target> list;
  double total = 0, so_far = 0;
  for (std::uint32_t i = 0; i < efforts.size() && list.size() < most; ++i) {
    if (!(efforts[i] > 0 && efforts[i] >= least)) continue;
    list.push_back({i, efforts[i], 0});
    total += efforts[i];
  }
  for (Target& t : list) {
    t.share /= total;
    t.cumulative = so_far += t.share;
  }
  return list;
}

namespace {

constexpr int choices = 8;
constexpr double weight_of_parts = 0.25;  // measured: more slows enclosures, less gains nothing elsewhere
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
  for (std::size_t i = 0; i < arriving.size(); ++i) all += arriving.share(i);
  double const unit = std::max(all, emitted);
  std::size_t const parts = *std::ranges::max_element(part_of) + 1;
  std::vector<Sums> of_part(parts);
  PerChoice const choice = shares_from(least);
  PerChoice cost{};
  for (Worth const& worth : worths) {
    std::ranges::fill(of_part, Sums{});
    for (std::size_t i = 0; i < arriving.size(); ++i) {
      double const f = arriving.share(i) / unit, a = worth.adjoint[i];
      if (!(f * a > 0)) continue;
      double const peak = arriving.peak(i) / unit;
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
  return choice[std::size_t(std::ranges::min_element(cost) - cost.begin())];
}

}  // namespace straytrace::trace
