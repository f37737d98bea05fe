// SPDX-License-Identifier: BSD-3-Clause
// Spherical cap in vertex form: mirror and lens faces. Points p relative to the vertex obey
// curvature |p|^2 = 2 p.axis, which has no far centre to subtract and is exact for curvature 0.
// Keys: cap.cpp; page: docs/reference/shapes/cap.md.
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"

namespace straytrace {

struct Cap {
  Vec3 vertex, axis{0, 0, 1};  // m; unit axis, points to the centre of curvature when curvature > 0
  double curvature = 0, inner_radius = 0, outer_radius = 1;  // 1/m, m, m
  static constexpr char const* key = "cap";

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
    return p + (0.5 * curvature * length2(o) - dot(axis, o)) * normal(p);
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
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    double const a = curvature * depth(inner_radius), b = curvature * depth(outer_radius);
    low = a < b ? a : b;
    high = a < b ? b : a;
    r_min = inner_radius;
    r_max = outer_radius;
  }
  STRAY_HD Vec3 reference() const { return vertex; }
  STRAY_HD Box bounds() const {
    double low, high, r_min, r_max;
    extent(low, high, r_min, r_max);
    return box_about_axis(reference(), axis, low, high, r_max);
  }
};

}  // namespace straytrace
