// SPDX-License-Identifier: BSD-3-Clause
// Elliptic disk, with or without an elliptic hole. Keys: ellipse.cpp; page: docs/reference/shapes/ellipse.md.
#pragma once

#include "geometry/plane_frame.hpp"
#include "geometry/redraw.hpp"

namespace straytrace {

struct Ellipse : PlaneFrame {
  double semi_x = 1, semi_y = 1;  // m, semi-axes along e1 and e2
  double hole_x = 0, hole_y = 0;  // m, semi-axes of the hole
  static constexpr char const* key = "ellipse";

  STRAY_HD bool in_hole(double x, double y) const {
    if (hole_x == 0) return false;
    double const a = x / hole_x, b = y / hole_y;
    return a * a + b * b < 1;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return meet(r, leaving, [this](double x, double y) {
      double const a = x / semi_x, b = y / semi_y;
      return a * a + b * b <= 1 && !in_hole(x, y);
    });
  }
  STRAY_HD double area() const { return pi * (semi_x * semi_y - hole_x * hole_y); }
  STRAY_HD Vec3 sample(double u, double v) const {  // similar ellipses from the largest one within the hole outwards
    double const inner = std::fmin(hole_x / semi_x, hole_y / semi_y);
    Redraw more(u, v);
    for (;;) {
      double const s = std::sqrt(inner * inner + u * (1 - inner * inner));
      SinCos const a = sincos_turn(v);
      double const x = semi_x * s * a.cos, y = semi_y * s * a.sin;
      if (!in_hole(x, y)) return at(x, y);
      u = more.next();
      v = more.next();
    }
  }
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = high = 0;
    r_min = std::fmin(hole_x, hole_y);
    r_max = std::fmax(semi_x, semi_y);
  }
  STRAY_HD Box bounds() const {
    Vec3 const a = semi_x * e1, b = semi_y * e2;
    Vec3 const side{std::sqrt(a.x * a.x + b.x * b.x), std::sqrt(a.y * a.y + b.y * b.y),
                    std::sqrt(a.z * a.z + b.z * b.z)};
    return {origin - side, origin + side};
  }
};

}  // namespace straytrace
