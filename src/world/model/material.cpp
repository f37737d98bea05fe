// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/material.hpp"

#include <algorithm>
#include <cmath>

#include "base/input/table.hpp"
#include "base/math/constants.hpp"
#include "optics/coating/specular.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {
namespace {

void read_bracket(Node const& bracket, ScatterSpread& spread) {
  std::vector<Node> const parts = bracket.as_list();
  bool const brdf = !parts.empty() && parts.front().kind() == Node::Kind::scalar &&
                    parts.front().as_quantity().dimension == dim::brdf;
  std::vector<double> const values = bracket.as_numbers(brdf ? dim::brdf : dim::plain, 3);
  if (values.size() != 3 || std::ranges::any_of(values, [](double v) { return !std::isfinite(v); })) return;
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
      if (world.material_optic(s.front) == info.optic || world.material_optic(s.back) == info.optic)
        material.groups.push_back(s.group);
    std::sort(material.groups.begin(), material.groups.end());
    material.groups.erase(std::unique(material.groups.begin(), material.groups.end()), material.groups.end());
    if (!material.groups.empty() && !(info.laws.empty() && !info.spread.stated())) all.push_back(std::move(material));
  }
  return all;
}

namespace {}  // namespace

MaterialShares shares_at(WorldView const& world, Optic const& optic, double degrees) {
  MaterialShares row{degrees, {}, 0, 0, 0, 0};
  double const cosine = std::cos(degrees * degree);
  for (int i = 0; i < optic.laws; ++i) row.laws.push_back(law_albedo(world.laws, optic, i, cosine));
  for (double share : row.laws) row.scattered += share;
  SpecularShares const s = specular_shares(world.interfaces, optic, cosine, 1, 1, true, row.scattered);
  row.reflect = s.reflect;
  row.transmit = s.transmit;
  row.absorbed = 1 - row.scattered - s.reflect - s.transmit;
  return row;
}

double bsdf_at(WorldView const& world, Optic const& optic, double degrees, double offset, int side) {
  double const sine = std::sin(degrees * degree), x = sine - offset;
  if (!(x > -1)) return -1;
  Vec3 const wi{-sine, 0, std::cos(degrees * degree)}, wo{x, 0, side * std::sqrt(1 - x * x)};
  return scatter_eval(world.laws, optic, wi, wo);
}

double scattered_share(World const& world, MaterialInfo const& info) {
  WorldView const view = world.view();
  return scatter_albedo(view.laws, view.optics[info.optic], 1.0);
}

}  // namespace straytrace::world
