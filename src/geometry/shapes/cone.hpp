// SPDX-License-Identifier: BSD-3-Clause
// Frustum of a cone: conical baffles. The rim of inner_radius lies at the origin; the ring opens along the axis with
// the half angle measured from the axis, so its outer edge is at height (outer - inner)/tan(half_angle).
// Keys: cone.cpp; page: docs/reference/shapes/cone.md.
#pragma once

#include <span>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

struct Cone {
  Vec3 origin, axis{0, 0, 1};                                      // m; unit axis
  double inner_radius = 0, outer_radius = 1, half_angle = pi / 4;  // m, m, rad in (0, pi/2)
  double sine = 0, cosine = 1;                                     // of half_angle, set by place()
  Vec3 apex;                                                       // set by place()
  static constexpr char const* key = "cone";
  static constexpr std::uint32_t drawn_rows = 1;
  static std::span<Key<Cone> const> keys();
  ShapeComplaint impossible() const;
  SurfaceCurvature curvature_at(Vec3 p) const;

  STRAY_HD void place(Pose const& pose) {
    origin = pose.origin;
    axis = pose.e3;
    SinCos const a = sincos_turn(half_angle / (2 * pi));
    sine = a.sin;
    cosine = a.cos;
    apex = origin - (inner_radius * cosine / sine) * axis;
  }
  STRAY_HD double height() const { return (outer_radius - inner_radius) * cosine / sine; }

  // Relative to the apex, points obey cos^2 |p_perp|^2 = sin^2 p_z^2 with p_z >= 0.
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [](Vec3) { return true; });
  }
  // First hit between the rims for which keep(offset from the axis) holds. Hits are accepted by their radius, so that
  // ring and wall of equal radius meet without a gap.
  template <class Keep>
  STRAY_HD double first(Ray const& r, bool leaving, Keep const& keep) const {
    Vec3 o = r.origin - apex;
    double shift = 0;
    double const size = outer_radius / sine;  // farthest point from the apex
    if (!leaving && length2(o) > 16 * size * size) {
      shift = -dot(o, r.dir);
      o = o + shift * r.dir;
    }
    double const oz = dot(o, axis), dz = dot(r.dir, axis);
    Vec3 const op = o - oz * axis, dp = r.dir - dz * axis;
    double const c2 = cosine * cosine, s2 = sine * sine;
    double const a = c2 * length2(dp) - s2 * dz * dz;
    double const b = c2 * dot(op, dp) - s2 * oz * dz;
    auto const accept = [&](double s) {
      double const t = shift + s;
      if (!(t > 0 && t < r.t_max && oz + s * dz >= 0)) return infinity;
      Vec3 const across = op + s * dp;
      double const rho2 = length2(across);
      bool const between = rho2 >= inner_radius * inner_radius && rho2 <= outer_radius * outer_radius;
      return between && keep(across) ? t : infinity;
    };
    if (leaving) return a == 0 ? infinity : accept(-2 * b / a);
    double const c = c2 * length2(op) - s2 * oz * oz;
    double const square = b * b - a * c;
    if (square < 0) return infinity;
    double const q = -(b + std::copysign(std::sqrt(square), b));
    double const one = a == 0 ? infinity : q / a, two = q == 0 ? infinity : c / q;
    double const near = accept(one < two ? one : two);
    return near < infinity ? near : accept(one < two ? two : one);
  }
  STRAY_HD Vec3 outward(Vec3 p) const {  // unit vector from the axis to p
    Vec3 const o = p - apex;
    return unit(o - dot(o, axis) * axis);
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return cosine * outward(p) - sine * axis; }  // away from the axis
  STRAY_HD Vec3 project(Vec3 p) const {
    Vec3 const o = p - apex;
    double const z = dot(o, axis);
    Vec3 const across = o - z * axis;
    double const rho = length(across), distance_off = cosine * rho - sine * z;
    return p - distance_off * ((cosine / rho) * across - sine * axis);
  }
  STRAY_HD double area() const { return pi * (outer_radius * outer_radius - inner_radius * inner_radius) / sine; }
  STRAY_HD Vec3 sample(double u, double v) const {
    double const rho =
        std::sqrt(inner_radius * inner_radius + u * (outer_radius * outer_radius - inner_radius * inner_radius));
    Frame const f = Frame::around(axis);
    SinCos const a = sincos_turn(v);
    return apex + (rho * cosine / sine) * axis + (rho * a.cos) * f.e1 + (rho * a.sin) * f.e2;
  }
  STRAY_HD Extent extent() const { return {0, height(), inner_radius, outer_radius}; }
  STRAY_HD Vec3 reference() const { return origin; }
  STRAY_HD Box bounds() const { return box_about_axis(origin, axis, 0, height(), outer_radius); }
};

// Conical or flat ring whose inner rim has triangular teeth. The tips of the teeth lie on inner_radius, where the ring
// is placed, the valleys between them at inner_radius + tooth_depth; in between the radius of the rim is linear in
// azimuth. Page: docs/reference/shapes/serrated_cone.md.
struct SerratedCone : Cone {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};
  double tooth_depth = 0.01, teeth = 100, phase = 0;  // m, measured across the axis; 1; rad, azimuth of a tip
  static constexpr char const* key = "serrated_cone";
  static std::span<Key<SerratedCone> const> keys();
  ShapeComplaint impossible() const;
  Drawing drawing() const;

  STRAY_HD void place(Pose const& pose) {
    Cone::place(pose);
    e1 = pose.e1;
    e2 = pose.e2;
    if (half_angle > pi / 2 - 1e-9) {  // flat
      sine = 1;
      cosine = 0;
      apex = origin;
    }
  }
  // Radius of the rim at an offset from the axis.
  STRAY_HD double rim(Vec3 across) const {
    double const x = (turn_of(dot(across, e1), dot(across, e2)) - phase / (2 * pi)) * teeth;
    return inner_radius + tooth_depth * (1 - std::fabs(1 - 2 * (x - std::floor(x))));
  }
  STRAY_HD bool on_teeth(Vec3 across) const {
    double const rho = length(across);
    return rho >= inner_radius + tooth_depth || rho >= rim(across);
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    if (cosine > 0) return first(r, leaving, [this](Vec3 at) { return on_teeth(at); });
    double const slope = dot(r.dir, axis);
    if (leaving || slope == 0) return infinity;
    Vec3 const o = r.origin - origin;
    double const t = -dot(o, axis) / slope;
    if (!(t > 0 && t < r.t_max)) return infinity;
    Vec3 const p = o + t * r.dir, across = p - dot(p, axis) * axis;
    return length(across) <= outer_radius && on_teeth(across) ? t : infinity;
  }
  // Integral of rim^2 over a part x of the way from tip to valley.
  STRAY_HD double squares(double x) const {
    return x * (inner_radius * inner_radius + tooth_depth * x * (inner_radius + tooth_depth * x / 3));
  }
  STRAY_HD double area() const { return pi * (outer_radius * outer_radius - squares(1)) / sine; }
  STRAY_HD Vec3 sample(double u, double v) const {
    double const outer2 = outer_radius * outer_radius, whole = outer2 - squares(1);
    double const flank = std::floor(2 * teeth * v), share = (2 * teeth * v - flank) * whole;
    auto const excess = [&](double x) {
      double const edge = inner_radius + tooth_depth * x;
      return Sloped{outer2 * x - squares(x) - share, outer2 - edge * edge};
    };
    double const x = bracketed_root(excess, 0, 1, true), edge = inner_radius + tooth_depth * x;
    bool const falling = flank - 2 * std::floor(0.5 * flank) == 1;  // from valley to tip
    SinCos const a = sincos_turn((flank + (falling ? 1 - x : x)) / (2 * teeth) + phase / (2 * pi));
    double const rho = std::sqrt(edge * edge + u * (outer2 - edge * edge));
    return apex + (rho * cosine / sine) * axis + (rho * a.cos) * e1 + (rho * a.sin) * e2;
  }
};

}  // namespace straytrace::geometry
