// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/sphere.hpp"

#include <fmt/format.h>

#include "base/input/table.hpp"

namespace straytrace::geometry {

std::span<Key<Sphere> const> Sphere::keys() {
  static constexpr Key<Sphere> keys[] = {
      {"radius", &Sphere::radius, dim::length, required, 1e-6, 1e6, "of the sphere"},
  };
  return keys;
}

SurfaceCurvature Sphere::curvature_at(Vec3 p) const { return SurfaceCurvature::uniform(normal(p), -1 / radius); }

std::span<Key<Zone> const> Zone::keys() {
  static constexpr Key<Zone> keys[] = {
      {"radius", &Zone::radius, dim::length, required, 1e-6, 1e6, "of the sphere"},
      {"from", &Zone::from, dim::length, required, -1e6, 1e6,
       "positions of the ends along the axis, relative to the centre of the sphere"},
      {"to", &Zone::to, dim::length, required, -1e6, 1e6,
       "positions of the ends along the axis, relative to the centre of the sphere"},
  };
  return keys;
}

ShapeComplaint Zone::impossible() const {
  if (from >= to)
    return {fmt::format("the zone ends ({:g} m) before it starts ({:g} m)", to, from), "make 'from' smaller than 'to'"};
  if (from < -radius || to > radius)
    return {fmt::format("the zone from {:g} m to {:g} m reaches beyond the sphere of radius {:g} m", from, to, radius),
            "heights are measured from the centre of the sphere"};
  return {};
}

std::span<Key<Cap> const> Cap::keys() {
  static constexpr Key<Cap> keys[] = {
      {"curvature", &Cap::curvature, dim::per_metre, 0, -1e3, 1e3,
       "1/radius of curvature; positive when concave towards the axis"},
      {"outer_radius", &Cap::outer_radius, dim::length, required, 1e-6, 1e3, "clear radius, measured across the axis"},
      {"inner_radius", &Cap::inner_radius, dim::length, 0, 0, 1e3, "radius of a central hole"},
  };
  return keys;
}

ShapeComplaint Cap::impossible() const {
  if (inner_radius >= outer_radius)
    return {fmt::format("the hole ({:g} m) is not smaller than the cap ({:g} m)", inner_radius, outer_radius),
            "make inner_radius smaller than outer_radius"};
  if (std::fabs(curvature) * outer_radius > 1)
    return {
        fmt::format("a sphere of radius {:g} m has no cap of radius {:g} m", 1 / std::fabs(curvature), outer_radius),
        "lower the curvature or the outer_radius"};
  return {};
}

SurfaceCurvature Cap::curvature_at(Vec3 p) const { return SurfaceCurvature::uniform(normal(p), curvature); }

}  // namespace straytrace::geometry
