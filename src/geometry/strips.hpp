// SPDX-License-Identifier: BSD-3-Clause
// Strips of a surface: parts of equal first sample coordinate u, which runs along radius or height. A strip from u_low
// to u_high has the area (u_high - u_low) area(), and sample(u, v) with u in between is uniform on it.
#pragma once

#include "geometry/shape_types.hpp"

namespace straytrace {

// First sample coordinate of a point on the surface: sample(u, v) = p for some v. Shapes that are not listed have a
// single strip.
template <class Shape>
STRAY_HD double strip_coordinate(Shape const&, Vec3) {
  return 0.5;
}
template <class Shape>
inline constexpr bool has_strips = false;

template <>
inline constexpr bool has_strips<Disk> = true;
STRAY_HD double strip_coordinate(Disk const& s, Vec3 p) {
  Vec3 const o = p - s.centre;
  double const inner2 = s.inner_radius * s.inner_radius;
  return (length2(o - dot(o, s.axis) * s.axis) - inner2) / (s.outer_radius * s.outer_radius - inner2);
}
template <>
inline constexpr bool has_strips<Cylinder> = true;
STRAY_HD double strip_coordinate(Cylinder const& s, Vec3 p) {
  return (dot(p - s.origin, s.axis) - s.from) / (s.to - s.from);
}
template <>
inline constexpr bool has_strips<Cone> = true;
STRAY_HD double strip_coordinate(Cone const& s, Vec3 p) {
  Vec3 const o = p - s.apex;
  double const inner2 = s.inner_radius * s.inner_radius;
  return (length2(o - dot(o, s.axis) * s.axis) - inner2) / (s.outer_radius * s.outer_radius - inner2);
}
template <>
inline constexpr bool has_strips<Cap> = true;
STRAY_HD double strip_coordinate(Cap const& s, Vec3 p) {
  Vec3 const o = p - s.vertex;
  double const inner = s.depth(s.inner_radius), rho = length(o - dot(o, s.axis) * s.axis);
  double const limit = s.curvature == 0 ? rho : std::fmin(rho, 1 / std::fabs(s.curvature));
  return (s.depth(limit) - inner) / (s.depth(s.outer_radius) - inner);
}
template <>
inline constexpr bool has_strips<Sphere> = true;
STRAY_HD double strip_coordinate(Sphere const& s, Vec3 p) { return 0.5 - 0.5 * (p.z - s.centre.z) / s.radius; }

}  // namespace straytrace
