// SPDX-License-Identifier: BSD-3-Clause
// Inner rims of rings, where light of a beam that passes through is cut off: disks, caps and cones with a hole.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"

namespace straytrace {

class World;

struct InnerRim {
  SurfaceId surface;
  Vec3 centre, axis, e1, e2;  // of the circle of the tips; unit vectors
  double radius = 0;          // m, of the tips
  double tooth_depth = 0;     // m, from tip to valley across the axis; the teeth are triangular
  double slope = 0;           // m along `axis` per m of radius, in the teeth
  double teeth = 0, phase = 0;
};
// None: the surface has no hole.
std::optional<InnerRim> rim_of(World const&, SurfaceId);
double rim_radius(InnerRim const&, double azimuth);  // m
Vec3 rim_point(InnerRim const&, double azimuth);     // from e1 towards e2

// The table `edges` of a scene: which rims diffract light from one mirror of a cavity to the other.
struct EdgeSettings {
  enum class Sum { independent, geometric, in_phase };  // of the rims of one group: powers, or fields
  std::vector<std::string> groups;
  Vec3 offset;              // m, added to the place of every rim
  double tooth_height = 0;  // m, random heights, besides teeth that the shape has
  double tooth_width = 0;   // m, of one such tooth
  Sum sum = Sum::independent;
};

}  // namespace straytrace
