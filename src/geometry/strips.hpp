// SPDX-License-Identifier: BSD-3-Clause
// Strips of a surface: parts of equal first sample coordinate u, which runs along radius or height, and in meshes from
// neighbour to neighbour. A strip from u_low to u_high has the area (u_high - u_low) area(), and sample_in_strip(u, v)
// with u in between is uniform on it.
#pragma once

#include "geometry/shape_types.hpp"

namespace straytrace {

template <class Shape>
STRAY_HD SurfacePoint sample_in_strip(Shape const& s, double u, double v) {
  return sample_of(s, u, v);
}
STRAY_HD SurfacePoint sample_in_strip(TriangleMesh const& s, double u, double v) { return s.sample_in_order(u, v); }

// First sample coordinate of a point on the surface: sample_in_strip(u, v) = p for some v. Shapes that are not listed
// have a single strip.
template <class Shape>
STRAY_HD double strip_coordinate(Shape const&, Vec3, std::uint32_t) {
  return 0.5;
}
// Edges of the strips of a mesh lie between triangles, so that all points of one are on the same strip.
STRAY_HD double strip_coordinate(TriangleMesh const& s, Vec3, std::uint32_t piece) { return s.order_coordinate(piece); }
STRAY_HD double strip_coordinate(Disk const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.centre;
  double const inner2 = s.inner_radius * s.inner_radius;
  return (length2(o - dot(o, s.axis) * s.axis) - inner2) / (s.outer_radius * s.outer_radius - inner2);
}
STRAY_HD double strip_coordinate(Cylinder const& s, Vec3 p, std::uint32_t) {
  return (dot(p - s.origin, s.axis) - s.from) / (s.to - s.from);
}
STRAY_HD double strip_coordinate(Cone const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.apex;
  double const inner2 = s.inner_radius * s.inner_radius;
  return (length2(o - dot(o, s.axis) * s.axis) - inner2) / (s.outer_radius * s.outer_radius - inner2);
}
STRAY_HD double strip_coordinate(Cap const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.vertex;
  double const inner = s.depth(s.inner_radius), rho = length(o - dot(o, s.axis) * s.axis);
  double const limit = s.curvature == 0 ? rho : std::fmin(rho, 1 / std::fabs(s.curvature));
  return (s.depth(limit) - inner) / (s.depth(s.outer_radius) - inner);
}
STRAY_HD double strip_coordinate(Sphere const& s, Vec3 p, std::uint32_t) {
  return 0.5 - 0.5 * (p.z - s.centre.z) / s.radius;
}

}  // namespace straytrace
