// SPDX-License-Identifier: BSD-3-Clause
// How a surface bends at a point of it: what a beam feels at a mirror or a lens face. Closed forms for every shape.
#pragma once

#include "geometry/shape_types.hpp"

namespace straytrace {

// Symmetric tensor in the tangent plane, 1/m. The height of the surface over that plane, along the unit normal of the
// shape (normal_of), is (1/2) r.K.r: positive where the surface bends towards its normal, so that a mirror is concave
// to light that comes against the normal. The derivative of the unit normal along r is -K r.
struct SurfaceCurvature {
  Vec3 a{1, 0, 0}, b{0, 1, 0};    // unit tangents at right angles to each other
  double aa = 0, ab = 0, bb = 0;  // a.K.a, a.K.b, b.K.b

  STRAY_HD bool flat() const { return aa == 0 && ab == 0 && bb == 0; }
  // u.K.v of any two vectors: their parts along the normal do not count.
  STRAY_HD double between(Vec3 u, Vec3 v) const {
    double const ua = dot(u, a), ub = dot(u, b), va = dot(v, a), vb = dot(v, b);
    return ua * (aa * va + ab * vb) + ub * (ab * va + bb * vb);
  }
  // The same surface for the opposite normal.
  STRAY_HD SurfaceCurvature from_behind() const { return {a, b, -aa, -ab, -bb}; }
};

namespace curvature_detail {

STRAY_HD SurfaceCurvature everywhere(Vec3 normal, double curvature) {
  Frame const f = Frame::around(normal);
  return {f.e1, f.e2, curvature, 0, curvature};
}
// A surface of revolution: principal directions run around the axis and at right angles to that.
STRAY_HD SurfaceCurvature revolved(Vec3 axis, Vec3 outward, Vec3 normal, double around, double across) {
  Vec3 const ring = cross(axis, outward);
  return {ring, cross(normal, ring), around, 0, across};
}

}  // namespace curvature_detail

// Flat, piece by piece: disks, polygons, boxes, triangles of a mesh.
template <class Shape>
STRAY_HD SurfaceCurvature curvature_of(Shape const& s, Vec3 p, std::uint32_t piece) {
  return curvature_detail::everywhere(normal_of(s, p, piece), 0);
}
STRAY_HD SurfaceCurvature curvature_of(Cap const& s, Vec3 p, std::uint32_t) {
  return curvature_detail::everywhere(s.normal(p), s.curvature);
}
STRAY_HD SurfaceCurvature curvature_of(Sphere const& s, Vec3 p, std::uint32_t) {
  return curvature_detail::everywhere(s.normal(p), -1 / s.radius);
}
STRAY_HD SurfaceCurvature curvature_of(Zone const& s, Vec3 p, std::uint32_t piece) {
  return curvature_of(static_cast<Sphere const&>(s), p, piece);
}
STRAY_HD SurfaceCurvature curvature_of(Cylinder const& s, Vec3 p, std::uint32_t) {
  Vec3 const normal = s.normal(p);
  return curvature_detail::revolved(s.axis, normal, normal, -1 / s.radius, 0);
}
STRAY_HD SurfaceCurvature curvature_of(CutCylinder const& s, Vec3 p, std::uint32_t piece) {
  return curvature_of(static_cast<Cylinder const&>(s), p, piece);
}
STRAY_HD SurfaceCurvature curvature_of(PiercedCylinder const& s, Vec3 p, std::uint32_t piece) {
  return curvature_of(static_cast<Cylinder const&>(s), p, piece);
}
STRAY_HD SurfaceCurvature curvature_of(Cone const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.apex;
  double const rho = length(o - dot(o, s.axis) * s.axis);
  return curvature_detail::revolved(s.axis, s.outward(p), s.normal(p), -s.cosine / rho, 0);
}
STRAY_HD SurfaceCurvature curvature_of(SerratedCone const& s, Vec3 p, std::uint32_t piece) {
  return curvature_of(static_cast<Cone const&>(s), p, piece);
}
STRAY_HD SurfaceCurvature curvature_of(Torus const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = p - s.centre, across = o - dot(o, s.axis) * s.axis, normal = s.normal(p);
  double const rho = length(across);
  Vec3 const outward = (1 / rho) * across;
  return curvature_detail::revolved(s.axis, outward, normal, -dot(outward, normal) / rho, -1 / s.minor_radius);
}
STRAY_HD SurfaceCurvature curvature_of_carrier(CadFace const& s, Vec3 p) {
  switch (s.carrier) {
    case Carrier::plane:
      break;
    case Carrier::cylinder:
      return curvature_of(s.cylinder(), p, 0);
    case Carrier::cone:
      return curvature_of(s.cone(), p, 0);
    case Carrier::sphere:
      return curvature_of(s.sphere(), p, 0);
    case Carrier::torus:
      return curvature_of(s.torus(), p, 0);
  }
  return curvature_detail::everywhere(s.axis, 0);
}
STRAY_HD SurfaceCurvature curvature_of(CadFace const& s, Vec3 p, std::uint32_t) {
  SurfaceCurvature const k = curvature_of_carrier(s, p);
  return s.sense > 0 ? k : k.from_behind();
}
// Height s(w), w = rho^2: slope ds/drho = 2 rho s_w, second derivative 2 s_w + 4 w s_ww.
STRAY_HD SurfaceCurvature curvature_of(Conic const& s, Vec3 p, std::uint32_t) {
  Vec3 const o = s.local(p - s.vertex), normal = s.normal(p);
  double const w = o.x * o.x + o.y * o.y, rho = std::sqrt(w), root = s.root_of(w), c = s.curvature;
  double const slope_w = s.steepness(w);
  double const bend_w = (1 + s.conic_constant) * c * c * c / (4 * root * root * root) + 2 * s.a4 +
                        w * (6 * s.a6 + w * (12 * s.a8 + w * 20 * s.a10));
  double const long_way = std::sqrt(1 + 4 * w * slope_w * slope_w);
  double const around = 2 * slope_w / long_way;
  if (!(rho > 0)) return curvature_detail::everywhere(normal, around);
  double const across = (2 * slope_w + 4 * w * bend_w) / (long_way * long_way * long_way);
  return curvature_detail::revolved(s.axis, s.world({o.x / rho, o.y / rho, 0}), normal, around, across);
}

}  // namespace straytrace
