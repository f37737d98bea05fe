// SPDX-License-Identifier: BSD-3-Clause
// Spherical shapes: full sphere, zone, cap. Keys: sphere.cpp.
#pragma once

#include <span>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

// Page: docs/reference/shapes/sphere.md.
struct Sphere {
  Vec3 centre, axis{0, 0, 1};  // m; the axis has no meaning for the surface
  double radius = 1;           // m
  static constexpr char const* key = "sphere";
  static std::span<Key<Sphere> const> keys();
  SurfaceCurvature curvature_at(Vec3 p) const;

  STRAY_HD void place(Pose const& pose) {
    centre = pose.origin;
    axis = pose.e3;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [](Vec3) { return true; });
  }
  // First hit for which keep(position relative to the centre) holds.
  template <class Keep>
  STRAY_HD double first(Ray const& r, bool leaving, Keep const& keep) const {
    Vec3 const o = r.origin - centre;
    double const b = dot(o, r.dir);
    auto const accept = [&](double t) { return t > 0 && t < r.t_max && keep(o + t * r.dir) ? t : infinity; };
    if (leaving) return accept(-2 * b);
    Vec3 const q = o - b * r.dir;  // point nearest the centre
    double const square = radius * radius - length2(q);
    if (square < 0) return infinity;
    double const half_chord = std::sqrt(square);  // both roots from q: a tangent at the origin has no other
    double const near = accept(-b - half_chord);
    return near < infinity ? near : accept(-b + half_chord);
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return unit(p - centre); }  // outward
  STRAY_HD Vec3 project(Vec3 p) const { return centre + radius * unit(p - centre); }
  STRAY_HD double area() const { return 4 * pi * radius * radius; }
  STRAY_HD Vec3 sample(double u, double v) const {
    double const z = 1 - 2 * u, rho = std::sqrt(4 * u * (1 - u));
    SinCos const a = sincos_turn(v);
    return centre + radius * Vec3{rho * a.cos, rho * a.sin, z};
  }
  STRAY_HD Extent extent() const { return {-radius, radius, 0, radius}; }
  STRAY_HD Vec3 reference() const { return centre; }
  STRAY_HD Box bounds() const {
    Vec3 const r{radius, radius, radius};
    return {centre - r, centre + r};
  }
};

// Sphere between two heights: partial spheres, bowls, collars. Page: docs/reference/shapes/zone.md.
struct Zone : Sphere {
  double from = -1, to = 1;  // m, along the axis, measured from the centre
  static constexpr char const* key = "zone";
  static std::span<Key<Zone> const> keys();
  ShapeComplaint impossible() const;

  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [this](Vec3 o) {
      double const z = dot(o, axis);
      return z >= from && z <= to;
    });
  }
  STRAY_HD double area() const { return 2 * pi * radius * (to - from); }
  STRAY_HD double ring(double z) const { return std::sqrt(std::fmax(0.0, (radius - z) * (radius + z))); }
  STRAY_HD Vec3 sample(double u, double v) const {
    double const z = from + u * (to - from), rho = ring(z);
    Frame const f = Frame::around(axis);
    SinCos const a = sincos_turn(v);
    return centre + z * axis + (rho * a.cos) * f.e1 + (rho * a.sin) * f.e2;
  }
  STRAY_HD Extent extent() const {
    return {from, to, std::fmin(ring(from), ring(to)), from < 0 && to > 0 ? radius : std::fmax(ring(from), ring(to))};
  }
  // Along each direction the sphere itself ends the box where its pole lies within the zone, otherwise a rim does.
  STRAY_HD Box bounds() const {
    Vec3 const high{most(axis.x), most(axis.y), most(axis.z)}, low{most(-axis.x), most(-axis.y), most(-axis.z)};
    return {centre - low, centre + high};
  }
  STRAY_HD double most(double slope) const {  // of a direction with this component along the axis
    if (radius * slope >= from && radius * slope <= to) return radius;
    double const across = std::sqrt(std::fmax(0.0, 1 - slope * slope));
    return std::fmax(from * slope + ring(from) * across, to * slope + ring(to) * across);
  }
};

// Spherical cap in vertex form: mirror and lens faces. Points p relative to the vertex obey
// curvature |p|^2 = 2 p.axis, which has no far centre to subtract and is exact for curvature 0. Page:
// docs/reference/shapes/cap.md.
struct Cap {
  Vec3 vertex, axis{0, 0, 1};  // m; unit axis, points to the centre of curvature when curvature > 0
  double curvature = 0, inner_radius = 0, outer_radius = 1;  // 1/m, m, m
  static constexpr char const* key = "cap";
  static constexpr std::uint32_t drawn_rows = 8;
  static std::span<Key<Cap> const> keys();
  ShapeComplaint impossible() const;
  SurfaceCurvature curvature_at(Vec3 p) const;

  STRAY_HD void place(Pose const& pose) {
    vertex = pose.origin;
    axis = pose.e3;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    Vec3 const o = r.origin - vertex;
    if (leaving) {  // one root is 0, the other is exact
      double const slope = dot(axis - curvature * o, r.dir);
      return curvature == 0 ? infinity : accept(2 * slope / curvature, o, r);
    }
    double const near = -dot(o, r.dir);  // solve from the point nearest the vertex: no cancellation far away
    Vec3 const q = o + near * r.dir;
    double const b = -dot(axis, r.dir), c = curvature * length2(q) - 2 * dot(axis, q);
    double const square = b * b - curvature * c;
    if (square < 0) return infinity;
    double const s = -(b + std::copysign(std::sqrt(square), b));
    double const one = s == 0 ? infinity : near + c / s;
    double const two = curvature == 0 ? infinity : near + s / curvature;
    double const first = accept(one < two ? one : two, o, r);
    return first < infinity ? first : accept(one < two ? two : one, o, r);
  }
  STRAY_HD double accept(double t, Vec3 o, Ray const& r) const {
    if (!(t > 0 && t < r.t_max)) return infinity;
    Vec3 const p = o + t * r.dir;
    double const height = dot(p, axis);
    Vec3 const across = p - height * axis;
    double const rho2 = length2(across);
    bool const on_cap = rho2 >= inner_radius * inner_radius && rho2 <= outer_radius * outer_radius;
    return on_cap && curvature * height < 1 ? t : infinity;  // the hemisphere at the vertex
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return unit(axis - curvature * (p - vertex)); }
  STRAY_HD Vec3 project(Vec3 p) const {  // one Newton step back onto the surface
    Vec3 const o = p - vertex;
    return p + (0.5 * curvature * length2(o) - dot(axis, o)) * (axis - curvature * o);  // a unit vector on the surface
  }
  // Height over curvature at radius rho; area is linear in it.
  STRAY_HD double depth(double rho) const {
    double const x = curvature * rho;
    return rho * rho / (1 + std::sqrt(1 - x * x));
  }
  STRAY_HD double area() const { return 2 * pi * (depth(outer_radius) - depth(inner_radius)); }
  STRAY_HD Vec3 sample(double u, double v) const {  // uniform in area
    double const g = depth(inner_radius) + u * (depth(outer_radius) - depth(inner_radius));
    double const rho = std::sqrt(2 * g - curvature * curvature * g * g);
    Frame const f = Frame::around(axis);
    SinCos const a = sincos_turn(v);
    return vertex + (curvature * g) * axis + (rho * a.cos) * f.e1 + (rho * a.sin) * f.e2;
  }
  STRAY_HD Extent extent() const {
    double const a = curvature * depth(inner_radius), b = curvature * depth(outer_radius);
    return {a < b ? a : b, a < b ? b : a, inner_radius, outer_radius};
  }
  STRAY_HD Vec3 reference() const { return vertex; }
  STRAY_HD Box bounds() const {
    Extent const e = extent();
    return box_about_axis(reference(), axis, e.low, e.high, e.r_max);
  }
};

}  // namespace straytrace::geometry
