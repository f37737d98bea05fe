// SPDX-License-Identifier: BSD-3-Clause
#include "trace/importance/targets.hpp"

#include <algorithm>
#include <map>

namespace straytrace {
namespace {

// Adds the effort for one goal: half by worth; half evenly over the bodies, and over the groups of each, that are worth
// anything, since a faint part of the scene may be the one that shakes.
void add_goal(std::vector<double>& effort, std::vector<double> const& worth, Parts const& parts) {
  std::vector<double> of_part(parts.body.size(), 0);
  double total = 0;
  for (std::size_t i = 0; i < worth.size(); ++i) {
    of_part[parts.of_patch[i]] += worth[i];
    total += worth[i];
  }
  std::map<std::uint32_t, double> groups;  // per body
  for (std::size_t k = 0; k < of_part.size(); ++k)
    if (of_part[k] > 0) ++groups[parts.body[k]];
  std::vector<double> share(of_part.size(), 0);  // per unit of worth
  for (std::size_t k = 0; k < of_part.size(); ++k)
    if (of_part[k] > 0) share[k] = 0.5 / total + 0.5 / (double(groups.size()) * groups[parts.body[k]] * of_part[k]);
  for (std::size_t i = 0; i < worth.size(); ++i) effort[i] += share[parts.of_patch[i]] * worth[i];
}

}  // namespace

Parts parts_of(World const& world, SteeringTables const& tables) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  Parts parts;
  for (Patch const& p : tables.patches) {  // its first strip speaks for it
    SurfaceId const id = tables.strips[tables.members[p.first].strip].surface;
    Surface const& surface = world.surfaces()[id.value];
    auto const [at, added] =
        numbers.emplace(std::pair{surface.body.value, surface.group.value}, std::uint32_t(numbers.size()));
    if (added) parts.body.push_back(surface.body.value);
    parts.of_patch.push_back(at->second);
  }
  return parts;
}

std::vector<Target> targets_of(Parts const& parts, std::vector<float> const& transfer, std::vector<Worth> const& worths,
                               std::size_t most) {
  std::vector<Target> list;
  if (transfer.empty()) return list;
  std::size_t const patches = parts.of_patch.size();
  std::vector<double> effort(patches, 0), worth(patches);
  for (auto const& [adjoint, hops] : worths) {
    for (std::size_t i = 0; i < patches; ++i)
      worth[i] = double(transfer[2 * i]) * adjoint[2 * i] + double(transfer[2 * i + 1]) * adjoint[2 * i + 1];
    add_goal(effort, worth, parts);
  }
  for (std::uint32_t i = 0; i < patches; ++i)
    if (effort[i] > 0) list.push_back({i, effort[i], 0});
  auto const brighter = [](Target const& a, Target const& b) {
    return a.share != b.share ? a.share > b.share : a.patch < b.patch;
  };
  if (list.size() > most) {
    std::nth_element(list.begin(), list.begin() + std::ptrdiff_t(most), list.end(), brighter);
    list.resize(most);
  }
  std::sort(list.begin(), list.end(), [](Target const& a, Target const& b) { return a.patch < b.patch; });
  double total = 0, so_far = 0;
  for (Target const& t : list) total += t.share;
  for (Target& t : list) {
    t.share /= total;
    t.cumulative = so_far += t.share;
  }
  return list;
}

}  // namespace straytrace
