// SPDX-License-Identifier: BSD-3-Clause
// Flat disk or annulus: flat baffles, end plates, flat optics. Keys: disk.cpp; page: docs/reference/shapes/disk.md.
#pragma once

#include "base/functions.hpp"
#include "base/vec3.hpp"

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

}  // namespace straytrace
