// SPDX-License-Identifier: BSD-3-Clause
// Side wall of a circular cylinder, open at both ends: tubes, barrels. Keys: cylinder.cpp; page:
// docs/reference/shapes/cylinder.md.
#pragma once

#include "base/functions.hpp"
#include "base/vec3.hpp"

namespace straytrace {

struct Cylinder {
  Vec3 origin, axis{0, 0, 1};           // m; unit axis
  double radius = 1, from = 0, to = 1;  // m; ends along the axis, measured from the origin
  static constexpr char const* key = "cylinder";

  STRAY_HD void place(Pose const& pose) {
    origin = pose.origin;
    axis = pose.e3;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [](Vec3, double) { return true; });
  }
  // First hit between the ends for which keep(offset from the axis, height) holds.
  template <class Keep>
  STRAY_HD double first(Ray const& r, bool leaving, Keep const& keep) const {
    Vec3 o = r.origin - origin;
    double const dz = dot(r.dir, axis);
    Vec3 const dp = r.dir - dz * axis;
    double const a = length2(dp);
    if (a == 0) return infinity;
    double oz = dot(o, axis);
    Vec3 op = o - oz * axis;
    double b = dot(op, dp), shift = 0;
    auto const accept = [&](double s) {
      double const t = shift + s, z = oz + s * dz;
      return t > 0 && t < r.t_max && z >= from && z <= to && keep(op + s * dp, z) ? t : infinity;
    };
    if (leaving) return accept(-2 * b / a);   // the other root of a quadric whose constant term is 0
    if (length2(op) > 4 * radius * radius) {  // far outside: solve from the point nearest the axis
      shift = -b / a;
      op = op + shift * dp;
      oz += shift * dz;
      b = dot(op, dp);
    }
    double const c = length2(op) - radius * radius;
    double const square = b * b - a * c;
    if (square < 0) return infinity;
    double const q = -(b + std::copysign(std::sqrt(square), b));
    double const one = q / a, two = c / q;
    double const near = accept(one < two ? one : two);
    return near < infinity ? near : accept(one < two ? two : one);
  }
  STRAY_HD Vec3 across(Vec3 p) const {
    Vec3 const o = p - origin;
    return o - dot(o, axis) * axis;
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return unit(across(p)); }  // away from the axis
  STRAY_HD Vec3 project(Vec3 p) const {
    Vec3 const op = across(p);
    double const rho = length(op);
    return p + ((radius - rho) / rho) * op;
  }
  STRAY_HD double area() const { return 2 * pi * radius * (to - from); }
  STRAY_HD Vec3 sample(double u, double v) const {
    Frame const f = Frame::around(axis);
    SinCos const a = sincos_turn(v);
    return origin + (from + u * (to - from)) * axis + (radius * a.cos) * f.e1 + (radius * a.sin) * f.e2;
  }
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = from;
    high = to;
    r_min = r_max = radius;
  }
  STRAY_HD Vec3 reference() const { return origin; }
  STRAY_HD Box bounds() const { return box_about_axis(origin, axis, from, to, radius); }
};

}  // namespace straytrace
