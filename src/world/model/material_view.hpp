// SPDX-License-Identifier: BSD-3-Clause
// What a material does to light, as numbers for people.
#pragma once

#include <vector>

#include "world/model/world.hpp"

namespace straytrace {

struct MaterialShares {
  double degrees;            // of incidence, in vacuum, vacuum behind
  std::vector<double> laws;  // scattered by each law
  double scattered, reflect, transmit, absorbed;
};
MaterialShares shares_at(WorldView const&, Optic const&, double degrees);

// BSDF in the plane of incidence at a distance |alpha - alpha_0| from the specular direction, towards the normal and
// past it; `side` 1: reflected, -1: transmitted. Negative: no such direction.
double bsdf_at(WorldView const&, Optic const&, double degrees, double offset, int side);

// Share of the light at normal incidence that a material scatters, to both sides together.
double scattered_share(World const&, MaterialInfo const&);

}  // namespace straytrace
