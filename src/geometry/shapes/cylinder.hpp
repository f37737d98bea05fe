// SPDX-License-Identifier: BSD-3-Clause
// Side wall of a circular cylinder, open at both ends: tubes, barrels. Keys: cylinder.cpp; page:
// docs/reference/shapes/cylinder.md.
#pragma once

#include <span>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

struct Cylinder {
  Vec3 origin, axis{0, 0, 1};           // m; unit axis
  double radius = 1, from = 0, to = 1;  // m; ends along the axis, measured from the origin
  static constexpr char const* key = "cylinder";
  static constexpr std::uint32_t drawn_rows = 1;
  static std::span<Key<Cylinder> const> keys();
  ShapeComplaint impossible() const;
  SurfaceCurvature curvature_at(Vec3 p) const;

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
  STRAY_HD Extent extent() const { return {from, to, radius, radius}; }
  STRAY_HD Vec3 reference() const { return origin; }
  STRAY_HD Box bounds() const { return box_about_axis(origin, axis, from, to, radius); }
};

// Side wall of a cylinder whose upper end is cut by a tilted plane: barrels of wedged plates. The end lies at
// to + x tan(tilt), x along e1. Page: docs/reference/shapes/cut_cylinder.md.
struct CutCylinder : Cylinder {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};
  double tilt = 0;   // rad
  double slope = 0;  // tan(tilt), set by place()
  double end = 1;    // m, `to`; the wall of the base class reaches to the highest point of the cut
  static constexpr char const* key = "cut_cylinder";
  static std::span<Key<CutCylinder> const> keys();
  ShapeComplaint impossible() const;

  STRAY_HD void place(Pose const& pose) {
    Cylinder::place(pose);
    e1 = pose.e1;
    e2 = pose.e2;
    SinCos const a = sincos_turn(tilt / (2 * pi));
    slope = a.sin / a.cos;
    to = end + radius * std::fabs(slope);
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [this](Vec3 at, double z) { return z <= end + slope * dot(at, e1); });
  }
  STRAY_HD double area() const { return 2 * pi * radius * (end - from); }
  STRAY_HD Vec3 sample(double u, double v) const {  // around the wall the length is 1 + ratio cos of its mean
    double const ratio = slope * radius / (end - from);
    auto const share = [&](double x) {
      SinCos const a = sincos_turn(x);
      return Sloped{x + ratio * a.sin / (2 * pi) - v, 1 + ratio * a.cos};
    };
    SinCos const a = sincos_turn(bracketed_root(share, 0, 1, true));
    double const x = radius * a.cos;
    return origin + (from + u * (end + slope * x - from)) * axis + x * e1 + (radius * a.sin) * e2;
  }
};

// Side wall of a cylinder with round holes, each drilled from outside to the axis: on one side only. Page:
// docs/reference/shapes/pierced_cylinder.md.
struct PiercedCylinder : Cylinder {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};
  double hole_radius = 0.1, hole_height = 0;  // m; height of the centres of the holes along the axis
  double hole_azimuth = 0, holes = 1;         // rad, of the first hole from e1; spread evenly around
  double surface = 0;                         // m^2, set by place()
  static constexpr char const* key = "pierced_cylinder";
  static std::span<Key<PiercedCylinder> const> keys();
  ShapeComplaint impossible() const;
  Drawing drawing() const;

  void place(Pose const& pose);

  // Points nearer to the line of a drill than its radius are gone, on the side of the axis where the drill is.
  STRAY_HD bool in_hole(Vec3 across, double z) const {
    double const up = z - hole_height;
    if (!(up * up < hole_radius * hole_radius)) return false;
    double const x = dot(across, e1), y = dot(across, e2), first = hole_azimuth / (2 * pi);
    double const nearest = std::floor((turn_of(x, y) - first) * holes + 0.5) / holes;
    SinCos const a = sincos_turn(nearest + first);
    double const side = y * a.cos - x * a.sin;
    return x * a.cos + y * a.sin > 0 && side * side + up * up < hole_radius * hole_radius;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [this](Vec3 at, double z) { return !in_hole(at, z); });
  }
  STRAY_HD double area() const { return surface; }
  STRAY_HD Vec3 sample(double u, double v) const {
    Redraw more(u, v);
    for (;;) {
      double const z = from + u * (to - from);
      SinCos const a = sincos_turn(v);
      Vec3 const out = (radius * a.cos) * e1 + (radius * a.sin) * e2;
      if (!in_hole(out, z)) return origin + z * axis + out;
      u = more.next();
      v = more.next();
    }
  }
};

}  // namespace straytrace::geometry
