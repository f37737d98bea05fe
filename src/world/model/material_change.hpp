// SPDX-License-Identifier: BSD-3-Clause
// What the materials of two models of one geometry differ in.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "world/model/material.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// The factor on the BSDF of a side if it is the same at all angles.
std::optional<double> common_factor(WorldView const& before, Optic const&, WorldView const& after, Optic const&);
// Whether reflectance and transmittance change by less than 0.1 % at any incidence.
bool same_coating(WorldView const& before, Optic const&, WorldView const& after, Optic const&);
// The largest ratio of the BSDF after and before over all directions in the plane of incidence; infinite where only
// that before is zero.
double largest_ratio(WorldView const& before, Optic const&, WorldView const& after, Optic const&);

struct MaterialChange {
  bool shape = false;  // of a BSDF: by more than one factor
  bool coating = false;
  std::vector<GroupId> groups;  // whose surfaces have a material that changes
};
MaterialChange change_of(World const& before, World const& after);

// Ratios at normal incidence.
struct CoatingRatio {
  double reflect = 1, transmit = 1;
};
std::map<std::uint32_t, CoatingRatio> coating_ratios(World const& before, World const& after);  // by group that changes

}  // namespace straytrace::world
