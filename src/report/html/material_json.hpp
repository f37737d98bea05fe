// SPDX-License-Identifier: BSD-3-Clause
// What a material does to light, for scripts and pages.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace {

inline constexpr double material_angles[] = {0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 89};  // deg of incidence, of shares
inline constexpr double material_incidences[] = {0, 30, 60, 80};                          // deg, of BSDF curves
std::vector<double> material_offsets(int per_decade, double low, double high);            // |alpha - alpha_0|

// Laws, shares of the light against incidence, BSDF curves against |alpha - alpha_0|.
nlohmann::json material_json(WorldView const&, MaterialInfo const&, std::vector<std::string> const& notes,
                             int per_decade = 30);

// All materials of a scene, with the measured points of tables: {deg, offset, bsdf} each, and how well each is known.
nlohmann::json materials_json(Scene const&, World const&);

}  // namespace straytrace
