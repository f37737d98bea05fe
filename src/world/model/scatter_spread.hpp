// SPDX-License-Identifier: BSD-3-Clause
// How well the scatter of a material is known: input of the error band, not of the trace.
#pragma once

#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "base/memory/ids.hpp"

namespace straytrace {

class World;

// Ratios to the value that is traced. A bracket is a range without a distribution; `factor` is one standard deviation
// of the logarithm: between 1/factor and factor.
struct ScatterSpread {
  double low = 1, high = 1, factor = 1;
  bool of_reflection = false;  // of the specular reflectance, not of the scatter
  std::string status;          // "assumed", "measured", ... of presets; empty: the scene's own numbers

  bool stated() const { return low < 1 || high > 1 || factor > 1; }
  // Two statements about one material: the wider of each kind.
  void widen(ScatterSpread const& other);
};

// `bracket: [low, mid, high]` (BRDF in 1/sr, or shares of the light) and `uncertainty: 30 %` or `factor 1.5` of a
// material or law. Problems go to the document.
ScatterSpread read_spread(Node const& table);

// A material that stands somewhere, with the groups whose surfaces have it on either side.
struct PlacedMaterial {
  std::string name;
  ScatterSpread spread;
  std::vector<GroupId> groups;
};
std::vector<PlacedMaterial> placed_materials(World const&);  // those that scatter or reflect, in the order of the scene

}  // namespace straytrace
