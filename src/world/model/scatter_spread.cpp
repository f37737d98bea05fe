// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/scatter_spread.hpp"

#include <algorithm>
#include <cmath>

#include "base/input/table.hpp"
#include "world/model/world.hpp"

namespace straytrace {
namespace {

void read_bracket(Node const& bracket, ScatterSpread& spread) {
  std::vector<Node> const parts = bracket.as_list();
  bool const brdf = !parts.empty() && parts.front().kind() == Node::Kind::scalar &&
                    parts.front().as_quantity().dimension == dim::brdf;
  std::vector<double> const values = bracket.as_numbers(brdf ? dim::brdf : dim::plain, 3);
  if (values.size() != 3 || std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }))
    return;
  if (!(values[0] > 0 && values[0] <= values[1] && values[1] <= values[2]))
    return bracket.problem("a bracket is low, mid, high, in this order and above zero",
                           "write [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]");
  spread.low = values[0] / values[1];
  spread.high = values[2] / values[1];
}

}  // namespace

void ScatterSpread::widen(ScatterSpread const& other) {
  low = std::min(low, other.low);
  high = std::max(high, other.high);
  factor = std::max(factor, other.factor);
}

ScatterSpread read_spread(Node const& table) {
  ScatterSpread spread;
  if (Node const bracket = table["bracket"]) read_bracket(bracket, spread);
  spread.factor = read_uncertainty(table["uncertainty"]);
  return spread;
}

std::vector<PlacedMaterial> placed_materials(World const& world) {
  std::vector<PlacedMaterial> all;
  for (MaterialInfo const& info : world.materials) {
    PlacedMaterial material{info.name, info.spread, {}};
    for (Surface const& s : world.surfaces())
      if (s.front == info.optic || s.back == info.optic) material.groups.push_back(s.group);
    std::sort(material.groups.begin(), material.groups.end());
    material.groups.erase(std::unique(material.groups.begin(), material.groups.end()), material.groups.end());
    if (!material.groups.empty() && !(info.laws.empty() && !info.spread.stated())) all.push_back(std::move(material));
  }
  return all;
}

}  // namespace straytrace
