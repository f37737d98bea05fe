// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/material_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace straytrace::world {
namespace {

constexpr std::array incidences{0.0, 1.0, 30.0, 60.0, 80.0};  // degrees

// Calls `action` with the BSDF before and after, in directions by 1 % of the distance from the specular one.
template <class Action>
void compare(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after, Action const& action) {
  for (double const degrees : incidences)
    for (double offset = 1e-7; offset < 1.5; offset *= 1.01)
      for (double const towards : {offset, -offset})
        for (int const side : {1, -1})
          action(bsdf_at(a, before, degrees, towards, side), bsdf_at(b, after, degrees, towards, side));
}

}  // namespace

std::optional<double> common_factor(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after) {
  double low = infinity, high = 0;
  compare(a, before, b, after, [&](double x, double y) {
    if (!(x > 0) && !(y > 0)) return;
    double const ratio = x > 0 ? std::max(y, 0.0) / x : infinity;
    low = std::min(low, ratio);
    high = std::max(high, ratio);
  });
  if (low > high) return 1.0;
  return high <= low * (1 + 1e-9) ? std::optional(high) : std::nullopt;
}

double largest_ratio(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after) {
  double largest = 0;
  compare(a, before, b, after, [&](double x, double y) {
    if (y > 0) largest = std::max(largest, x > 0 ? y / x : infinity);
  });
  return largest;
}

bool same_coating(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after) {
  return std::ranges::all_of(incidences, [&](double degrees) {
    MaterialShares const x = shares_at(a, before, degrees), y = shares_at(b, after, degrees);
    return std::fabs(x.reflect - y.reflect) <= 1e-3 * x.reflect &&
           std::fabs(x.transmit - y.transmit) <= 1e-3 * x.transmit;
  });
}

MaterialChange change_of(World const& before, World const& after) {
  MaterialChange change;
  WorldView const a = before.view(), b = after.view();
  std::vector<PlacedMaterial> const placed = placed_materials(before);
  for (std::size_t i = 0; i < before.materials.size() && i < after.materials.size(); ++i) {
    Optic const &was = a.optics[before.materials[i].optic], &is = b.optics[after.materials[i].optic];
    std::optional<double> const factor = common_factor(a, was, b, is);
    bool const coating = !same_coating(a, was, b, is);
    change.shape = change.shape || !factor;
    change.coating = change.coating || coating;
    if (factor == 1.0 && !coating) continue;
    for (PlacedMaterial const& m : placed)
      if (m.name == before.materials[i].name)
        change.groups.insert(change.groups.end(), m.groups.begin(), m.groups.end());
  }
  return change;
}

std::map<std::uint32_t, CoatingRatio> coating_ratios(World const& before, World const& after) {
  std::map<std::uint32_t, CoatingRatio> ratios;
  WorldView const a = before.view(), b = after.view();
  std::vector<PlacedMaterial> const placed = placed_materials(before);
  for (std::size_t i = 0; i < before.materials.size() && i < after.materials.size(); ++i) {
    MaterialShares const was = shares_at(a, a.optics[before.materials[i].optic], 0),
                         is = shares_at(b, b.optics[after.materials[i].optic], 0);
    CoatingRatio const ratio{was.reflect > 0 ? is.reflect / was.reflect : 1,
                             was.transmit > 0 ? is.transmit / was.transmit : 1};
    if (ratio.reflect == 1 && ratio.transmit == 1) continue;
    for (PlacedMaterial const& m : placed)
      if (m.name == before.materials[i].name)
        for (GroupId const group : m.groups) ratios[group.value] = ratio;
  }
  return ratios;
}

}  // namespace straytrace::world
