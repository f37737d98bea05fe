// SPDX-License-Identifier: BSD-3-Clause
// Side wall of a cylinder whose upper end is cut by a tilted plane: barrels of wedged plates. The end lies at
// to + x tan(tilt), x along e1. Keys: cut_cylinder.cpp; page: docs/reference/shapes/cut_cylinder.md.
#pragma once

#include "geometry/cylinder.hpp"
#include "geometry/roots.hpp"

namespace straytrace {

struct CutCylinder : Cylinder {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};
  double tilt = 0;   // rad
  double slope = 0;  // tan(tilt), set by place()
  double end = 1;    // m, `to`; the wall of the base class reaches to the highest point of the cut
  static constexpr char const* key = "cut_cylinder";

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

}  // namespace straytrace
