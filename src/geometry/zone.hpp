// SPDX-License-Identifier: BSD-3-Clause
// Sphere between two heights: partial spheres, bowls, collars. Keys: zone.cpp; page: docs/reference/shapes/zone.md.
#pragma once

#include "geometry/sphere.hpp"

namespace straytrace {

struct Zone : Sphere {
  double from = -1, to = 1;  // m, along the axis, measured from the centre
  static constexpr char const* key = "zone";

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
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = from;
    high = to;
    r_min = std::fmin(ring(from), ring(to));
    r_max = from < 0 && to > 0 ? radius : std::fmax(ring(from), ring(to));
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

}  // namespace straytrace
