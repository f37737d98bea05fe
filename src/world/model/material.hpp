// SPDX-License-Identifier: BSD-3-Clause
// Materials of a scene: sources of their numbers, their uncertainty (input of the error band, not of the trace), and
// their optical properties.
#pragma once

#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/memory/ids.hpp"
#include "optics/optic.hpp"

namespace straytrace {
class Node;
}  // namespace straytrace

namespace straytrace::world {

class World;
struct WorldView;

// Ratios to the value that is traced. A bracket is a range without a distribution; `factor` is one standard deviation
// of the logarithm: between 1/factor and factor.
struct ScatterSpread {
  double low = 1, high = 1, factor = 1;
  bool of_reflection = false;  // of the specular reflectance, not of the scatter
  std::string status;          // "assumed", "measured", ... of presets; empty: the scene's own numbers

  bool stated() const { return low < 1 || high > 1 || factor > 1; }
  // Combines two statements about one material: the wider of each kind.
  void widen(ScatterSpread const& other);
};

// `bracket: [low, mid, high]` (BRDF in 1/sr, or shares of the light) and `uncertainty: 30 %` or `factor 1.5` of a
// material or BSDF model. Adds its problems to the document.
ScatterSpread read_spread(Node const& table);

// Source of the numbers of a BSDF model.
struct LawInfo {
  std::string model, source, wavelength;
  std::string parameters = {};  // as written, "exponent 2, tis 5 ppm"; empty for a preset
  Place place = {};             // of the model in its file; line 0 for a preset
};
struct MaterialInfo {
  std::string name, source;
  std::vector<LawInfo> laws;
  std::uint32_t optic = 0;
  ScatterSpread spread;
};

// A material in use, with the groups whose surfaces have it on either side.
struct PlacedMaterial {
  std::string name;
  ScatterSpread spread;
  std::vector<GroupId> groups;
};
std::vector<PlacedMaterial> placed_materials(World const&);  // that scatter or reflect, in the order of the scene

struct MaterialShares {
  double degrees;            // of incidence, in vacuum, vacuum behind
  std::vector<double> laws;  // scattered by each BSDF model
  double scattered, reflect, transmit, absorbed;
};
MaterialShares shares_at(WorldView const&, Optic const&, double degrees);

// BSDF in the plane of incidence at a distance |alpha - alpha_0| from the specular direction, towards the normal and
// past it; `side` 1: reflected, -1: transmitted. Negative result: no such direction.
double bsdf_at(WorldView const&, Optic const&, double degrees, double offset, int side);

// Share of the light at normal incidence that a material scatters, to both sides together.
double scattered_share(World const&, MaterialInfo const&);

}  // namespace straytrace::world
