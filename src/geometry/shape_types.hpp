// SPDX-License-Identifier: BSD-3-Clause
// The list of shapes. A new shape needs NAME.hpp and NAME.cpp, its page, and its name here. A shape is a trivially
// copyable struct with `axis`, `key`, the name in the scene language, and
//   keys()                      its keys in the scene language, defined in NAME.cpp
//   place(pose)                 puts it into the world: origin of the shape, e3 its axis, e1 and e2 across
//   distance(ray, leaving)      m along the ray to the first hit in (0, t_max), infinity: none. `leaving`: the ray
//                               starts ON this surface, so the root at zero is not a hit; no epsilon anywhere
//   normal(p)                   unit normal of the front side; the page of the shape defines it
//   project(p)                  a computed hit put back on the surface (one Newton step)
//   area()                      m^2
//   sample(u, v)                a point uniform in area
//   extent()                    heights along `axis` from reference(), and distances from that axis, that contain the
//                               surface; r_min > 0 promises that nothing of it is nearer to the axis
//   bounds()                    box in the world that contains it
//   reference()                 the point its equations are written about
// and, where the default is not suitable,
//   impossible()                why its values do not make a shape (default: they do)
//   curvature_at(p)             of the surface at p (default: flat)
//   drawing()                   as triangles (default: a grid of samples, `drawn_rows` along the first number)
//   hides_itself                a line between two of its points may cross it (default: only for shapes with pieces)
//   largest_length()            m, beyond its bounds, from which hits are computed
// Shapes made of many flat pieces: common/shape.hpp.
#pragma once

#include <algorithm>
#include <tuple>

#include "geometry/cad/cad_face.hpp"
#include "geometry/mesh/triangle_mesh.hpp"
#include "geometry/shapes/cone.hpp"
#include "geometry/shapes/conic.hpp"
#include "geometry/shapes/cuboid.hpp"
#include "geometry/shapes/cylinder.hpp"
#include "geometry/shapes/flat.hpp"
#include "geometry/shapes/shape.hpp"
#include "geometry/shapes/sphere.hpp"
#include "geometry/shapes/torus.hpp"

namespace straytrace::geometry {

using ShapeTypes = std::tuple<Disk, Cap, Cylinder, Cone, Sphere, Conic, Rectangle, Ellipse, Polygon, Cuboid, Torus,
                              PiercedCylinder, SerratedCone, Zone, CutCylinder, TriangleMesh, CadFace>;

template <std::size_t... I>
STRAY_HD bool kind_may_hide_itself(std::uint32_t kind, std::index_sequence<I...>) {
  return ((kind == I && MayHideItself<std::tuple_element_t<I, ShapeTypes>>) || ...);
}
STRAY_HD bool kind_may_hide_itself(std::uint32_t kind) {
  return kind_may_hide_itself(kind, std::make_index_sequence<std::tuple_size_v<ShapeTypes>>());
}

// Accuracy of the point where a line meets a surface: docs/theory/sampling.md, eq. 1.14.

// The largest length from which hits on the shape are computed, m: a coordinate in the world of its points or of the
// point its equations are written about, or `largest_length` of the shape.
template <class Shape>
double scale_of(Shape const& s) {
  Box box = s.bounds();
  box.add(s.reference());
  Vec3 const &a = box.lower, &b = box.upper;
  double const scale = std::max({-a.x, -a.y, -a.z, b.x, b.y, b.z});
  if constexpr (requires { s.largest_length(); }) return std::max(scale, s.largest_length());
  return scale;
}

// A line to a point drawn on a surface, `way` m away, meets the surface at most this much before the point, m
// (eq. 1.14). `scale`: of the surface, m; `cosine`: between the line and the normal where they meet, not negative.
STRAY_HD double hit_slack(double scale, double way, double cosine) {
  double const slack = 0x1p-46 * (scale + way) / cosine;
  return slack < way ? slack : way;
}

// Strips of a surface: parts of equal first sample coordinate u, which runs along radius or height, and in meshes from
// neighbour to neighbour. A strip from u_low to u_high has the area (u_high - u_low) area(), and sample_in_strip(u, v)
// with u in between is uniform on it.

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
STRAY_HD double strip_coordinate(SerratedCone const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.apex, across = o - dot(o, s.axis) * s.axis;
  double const rim = s.rim(across), rim2 = rim * rim;
  return (length2(across) - rim2) / (s.outer_radius * s.outer_radius - rim2);
}
STRAY_HD double strip_coordinate(Cap const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.vertex;
  double const inner = s.inner_radius > 0 ? s.depth(s.inner_radius) : 0, rho = length(o - dot(o, s.axis) * s.axis);
  double const limit = s.curvature == 0 ? rho : std::fmin(rho, 1 / std::fabs(s.curvature));
  return (s.depth(limit) - inner) / (s.depth(s.outer_radius) - inner);
}
STRAY_HD double strip_coordinate(Sphere const& s, Vec3 p, std::uint32_t) {
  return 0.5 - 0.5 * (p.z - s.centre.z) / s.radius;
}

// A computed hit put back on its surface, with the unit normal there.
struct Landing {
  Vec3 point, normal;
};
template <class Shape>
STRAY_HD Landing landing_on(Shape const& s, Vec3 p, std::uint32_t piece) {
  Vec3 const point = projected_on(s, p, piece);
  return {point, normal_of(s, point, piece)};
}

}  // namespace straytrace::geometry
