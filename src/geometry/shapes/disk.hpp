// SPDX-License-Identifier: BSD-3-Clause
// Flat disk or annulus: flat baffles, end plates, flat optics. Keys: disk.cpp; page: docs/reference/shapes/disk.md.
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/common/plane_frame.hpp"
#include "geometry/common/redraw.hpp"

namespace straytrace {

struct Disk {
  Vec3 centre, axis{0, 0, 1};                 // m; unit normal
  double inner_radius = 0, outer_radius = 1;  // m
  static constexpr char const* key = "disk";

  STRAY_HD void place(Pose const& pose) {
    centre = pose.origin;
    axis = pose.e3;
  }
  // m along the ray; infinity: no hit. `leaving`: the ray starts ON this surface.
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    double const slope = dot(r.dir, axis);
    if (leaving || slope == 0) return infinity;
    Vec3 const o = r.origin - centre;
    double const t = -dot(o, axis) / slope;
    if (!(t > 0 && t < r.t_max)) return infinity;
    Vec3 const p = o + t * r.dir;
    double const rho2 = length2(p) - dot(p, axis) * dot(p, axis);
    return rho2 >= inner_radius * inner_radius && rho2 <= outer_radius * outer_radius ? t : infinity;
  }
  STRAY_HD Vec3 normal(Vec3) const { return axis; }
  STRAY_HD Vec3 project(Vec3 p) const { return p - dot(p - centre, axis) * axis; }
  STRAY_HD double area() const { return pi * (outer_radius * outer_radius - inner_radius * inner_radius); }
  STRAY_HD Vec3 sample(double u, double v) const {  // uniform in area
    double const rho =
        std::sqrt(inner_radius * inner_radius + u * (outer_radius * outer_radius - inner_radius * inner_radius));
    Frame const f = Frame::around(axis);
    SinCos const a = sincos_turn(v);
    return centre + (rho * a.cos) * f.e1 + (rho * a.sin) * f.e2;
  }
  // Heights along `axis` from `centre`, and radii about it, that contain the surface.
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = high = 0;
    r_min = inner_radius;
    r_max = outer_radius;
  }
  STRAY_HD Vec3 reference() const { return centre; }
  STRAY_HD Box bounds() const { return box_about_axis(centre, axis, 0, 0, outer_radius); }
};

// Elliptic disk, with or without an elliptic hole. Keys: ellipse.cpp; page: docs/reference/shapes/ellipse.md.

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
