// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cap.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Cap> const> keys_of<Cap>() {
  static constexpr Key<Cap> keys[] = {
      {"curvature", &Cap::curvature, dim::per_metre, 0, -1e3, 1e3, "1/radius, positive when concave towards the axis"},
      {"outer_radius", &Cap::outer_radius, dim::length, required, 1e-6, 1e3, "clear radius"},
      {"inner_radius", &Cap::inner_radius, dim::length, 0, 0, 1e3, "radius of the central hole"},
  };
  return keys;
}

ShapeComplaint impossible(Cap const& s) {
  if (s.inner_radius >= s.outer_radius)
    return {fmt::format("the hole ({:g} m) is not smaller than the cap ({:g} m)", s.inner_radius, s.outer_radius),
            "make inner_radius smaller than outer_radius"};
  if (std::fabs(s.curvature) * s.outer_radius > 1)
    return {fmt::format("a sphere of radius {:g} m has no cap of radius {:g} m", 1 / std::fabs(s.curvature),
                        s.outer_radius),
            "lower the curvature or the outer_radius"};
  return {};
}

}  // namespace straytrace
