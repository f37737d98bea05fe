// SPDX-License-Identifier: BSD-3-Clause
#include "trace/estimate/targets.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace straytrace {
namespace {

struct Part {  // of the scene
  std::uint32_t body, group;
  bool operator<(Part const& o) const { return std::tie(body, group) < std::tie(o.body, o.group); }
};

// Adds the effort for one goal: half by worth; half evenly over the bodies, and over the groups of each, that are worth
// anything, since a faint part of the scene may be the one that shakes.
void add_goal(std::vector<double>& effort, std::vector<double> const& worth, std::vector<Part> const& part) {
  std::map<Part, double> of_part;
  std::map<std::uint32_t, double> groups;  // per body
  double total = 0;
  for (std::size_t i = 0; i < worth.size(); ++i)
    if (worth[i] > 0) {
      if (of_part[part[i]] == 0) ++groups[part[i].body];
      of_part[part[i]] += worth[i];
      total += worth[i];
    }
  for (std::size_t i = 0; i < worth.size(); ++i)
    if (worth[i] > 0) {
      double const even = double(groups.size()) * groups[part[i].body] * of_part[part[i]];
      effort[i] += 0.5 * worth[i] * (1 / total + 1 / even);
    }
}

}  // namespace

std::vector<Target> targets_of(World const& world, SteeringTables const& tables, std::vector<double> const& transfer,
                               std::vector<std::vector<double>> const& adjoints, std::size_t most) {
  std::vector<Target> list;
  if (transfer.empty()) return list;
  std::size_t const strips = tables.strips.size();
  std::vector<double> effort(strips, 0), worth(strips);
  std::vector<Part> part;
  for (Strip const& s : tables.strips) {
    Surface const& surface = world.surfaces()[s.surface.value];
    part.push_back({surface.body.value, surface.group.value});
  }
  for (std::vector<double> const& adjoint : adjoints) {
    for (std::size_t i = 0; i < strips; ++i)
      worth[i] = transfer[2 * i] * adjoint[2 * i] + transfer[2 * i + 1] * adjoint[2 * i + 1];
    add_goal(effort, worth, part);
  }
  for (std::uint32_t i = 0; i < strips; ++i)
    if (effort[i] > 0) list.push_back({i, effort[i], 0});
  std::sort(list.begin(), list.end(), [](Target const& a, Target const& b) {
    return a.share != b.share ? a.share > b.share : a.strip < b.strip;
  });
  if (list.size() > most) list.resize(most);
  std::sort(list.begin(), list.end(), [](Target const& a, Target const& b) { return a.strip < b.strip; });
  double total = 0, so_far = 0;
  for (Target const& t : list) total += t.share;
  for (Target& t : list) {
    t.share /= total;
    t.cumulative = so_far += t.share;
  }
  return list;
}

}  // namespace straytrace
