// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/material_view.hpp"

#include <cmath>

#include "optics/coating/specular.hpp"
#include "world/model/degree.hpp"

namespace straytrace {
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

}  // namespace straytrace
