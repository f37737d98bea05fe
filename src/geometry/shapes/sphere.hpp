// SPDX-License-Identifier: BSD-3-Clause
// Full sphere. Keys: sphere.cpp; page: docs/reference/shapes/sphere.md.
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"

namespace straytrace {

struct Sphere {
  Vec3 centre, axis{0, 0, 1};  // m; the axis has no meaning for the surface
  double radius = 1;           // m
  static constexpr char const* key = "sphere";

  STRAY_HD void place(Pose const& pose) {
    centre = pose.origin;
    axis = pose.e3;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [](Vec3) { return true; });
  }
  // First hit whose place relative to the centre is one to keep.
  template <class Keep>
  STRAY_HD double first(Ray const& r, bool leaving, Keep const& keep) const {
    Vec3 const o = r.origin - centre;
    double const b = dot(o, r.dir);
    auto const accept = [&](double t) { return t > 0 && t < r.t_max && keep(o + t * r.dir) ? t : infinity; };
    if (leaving) return accept(-2 * b);
    Vec3 const q = o - b * r.dir;  // point nearest the centre
    double const square = radius * radius - length2(q);
    if (square < 0) return infinity;
    double const half_chord = std::sqrt(square);  // both roots from q: a tangent at the origin has no other
    double const near = accept(-b - half_chord);
    return near < infinity ? near : accept(-b + half_chord);
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return unit(p - centre); }  // outward
  STRAY_HD Vec3 project(Vec3 p) const { return centre + radius * unit(p - centre); }
  STRAY_HD double area() const { return 4 * pi * radius * radius; }
  STRAY_HD Vec3 sample(double u, double v) const {
    double const z = 1 - 2 * u, rho = std::sqrt(4 * u * (1 - u));
    SinCos const a = sincos_turn(v);
    return centre + radius * Vec3{rho * a.cos, rho * a.sin, z};
  }
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = -radius;
    high = radius;
    r_min = 0;
    r_max = radius;
  }
  STRAY_HD Vec3 reference() const { return centre; }
  STRAY_HD Box bounds() const {
    Vec3 const r{radius, radius, radius};
    return {centre - r, centre + r};
  }
};

// Sphere between two heights: partial spheres, bowls, collars. Keys: zone.cpp; page: docs/reference/shapes/zone.md.

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
