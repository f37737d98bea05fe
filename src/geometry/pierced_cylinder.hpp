// SPDX-License-Identifier: BSD-3-Clause
// Side wall of a cylinder with round holes, each drilled from outside to the axis: on one side only (requirements.md
// R3.14). Keys: pierced_cylinder.cpp; page: docs/reference/shapes/pierced_cylinder.md.
#pragma once

#include "geometry/cylinder.hpp"
#include "geometry/redraw.hpp"

namespace straytrace {

struct PiercedCylinder : Cylinder {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};
  double hole_radius = 0.1, hole_height = 0;  // m, of the drill; height of its line along the axis
  double hole_azimuth = 0, holes = 1;         // rad, of the first hole from e1; spread evenly around
  double surface = 0;                         // m^2, set by place()
  static constexpr char const* key = "pierced_cylinder";

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

}  // namespace straytrace
