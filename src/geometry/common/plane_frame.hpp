// SPDX-License-Identifier: BSD-3-Clause
// What flat shapes share: a plane with two directions in it.
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"

namespace straytrace {

struct PlaneFrame {
  Vec3 origin, e1{1, 0, 0}, e2{0, 1, 0}, axis{0, 0, 1};  // m; unit vectors, axis is the normal

  STRAY_HD void place(Pose const& pose) {
    origin = pose.origin;
    e1 = pose.e1;
    e2 = pose.e2;
    axis = pose.e3;
  }
  // Distance to the plane where `inside(x, y)` holds at the hit; a plane is left for good.
  template <class Inside>
  STRAY_HD double meet(Ray const& r, bool leaving, Inside const& inside) const {
    double const slope = dot(r.dir, axis);
    if (leaving || slope == 0) return infinity;
    Vec3 const o = r.origin - origin;
    double const t = -dot(o, axis) / slope;
    if (!(t > 0 && t < r.t_max)) return infinity;
    Vec3 const p = o + t * r.dir;
    return inside(dot(p, e1), dot(p, e2)) ? t : infinity;
  }
  STRAY_HD Vec3 normal(Vec3) const { return axis; }
  STRAY_HD Vec3 project(Vec3 p) const { return p - dot(p - origin, axis) * axis; }
  STRAY_HD Vec3 at(double x, double y) const { return origin + x * e1 + y * e2; }
  STRAY_HD Vec3 reference() const { return origin; }
};

}  // namespace straytrace
