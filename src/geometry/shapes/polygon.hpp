// SPDX-License-Identifier: BSD-3-Clause
// Regular polygon or circle, with or without a hole of the same kinds: apertures of blades. Keys: polygon.cpp; page:
// docs/reference/shapes/polygon.md.
#pragma once

#include "geometry/common/plane_frame.hpp"
#include "geometry/common/redraw.hpp"

namespace straytrace {

// Regular polygon about the origin of a plane.
struct RegularOutline {
  double sides, radius, rotation;  // 0 sides: a circle; m to the corners; rad, azimuth of the first corner
  double apothem;                  // m, distance of the sides from the centre

  STRAY_HD bool contains(double x, double y) const {
    if (sides == 0) return x * x + y * y <= radius * radius;
    double const first = rotation / (2 * pi);
    double const side = std::floor((turn_of(x, y) - first) * sides);  // at a corner either side will do
    SinCos const middle = sincos_turn((side + 0.5) / sides + first);
    return x * middle.cos + y * middle.sin <= apothem;
  }
  STRAY_HD double area() const {
    return sides == 0 ? pi * radius * radius : 0.5 * sides * radius * radius * sincos_turn(1 / sides).sin;
  }
  STRAY_HD static double apothem_of(double sides, double radius) {
    return sides == 0 ? radius : radius * sincos_turn(0.5 / sides).cos;
  }
};

struct Polygon : PlaneFrame {
  double sides = 6, radius = 1, rotation = 0;                 // 1, m, rad
  double hole_sides = 0, hole_radius = 0, hole_rotation = 0;  // 1, m, rad
  double apothem = 1, hole_apothem = 0;                       // m, set by place()
  static constexpr char const* key = "polygon";

  STRAY_HD void place(Pose const& pose) {
    PlaneFrame::place(pose);
    apothem = RegularOutline::apothem_of(sides, radius);
    hole_apothem = RegularOutline::apothem_of(hole_sides, hole_radius);
  }
  STRAY_HD RegularOutline outline() const { return {sides, radius, rotation, apothem}; }
  STRAY_HD RegularOutline hole() const { return {hole_sides, hole_radius, hole_rotation, hole_apothem}; }
  STRAY_HD bool covers(double x, double y) const {
    return outline().contains(x, y) && !(hole_radius > 0 && hole().contains(x, y));
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return meet(r, leaving, [this](double x, double y) { return covers(x, y); });
  }
  STRAY_HD double area() const { return outline().area() - (hole_radius > 0 ? hole().area() : 0); }
  STRAY_HD Vec3 sample(double u, double v) const {  // even in the ring that holds the plate, until it falls on it
    Redraw more(u, v);
    for (;;) {
      double const rho = std::sqrt(hole_apothem * hole_apothem + u * (radius * radius - hole_apothem * hole_apothem));
      SinCos const a = sincos_turn(v);
      if (covers(rho * a.cos, rho * a.sin)) return at(rho * a.cos, rho * a.sin);
      u = more.next();
      v = more.next();
    }
  }
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = high = 0;
    r_min = hole_apothem;
    r_max = radius;
  }
  STRAY_HD Box bounds() const {
    if (sides == 0) return box_about_axis(origin, axis, 0, 0, radius);
    Box box;
    for (double k = 0; k < sides; ++k) {
      SinCos const a = sincos_turn(k / sides + rotation / (2 * pi));
      box.add(at(radius * a.cos, radius * a.sin));
    }
    return box;
  }
};

}  // namespace straytrace
