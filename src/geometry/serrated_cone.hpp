// SPDX-License-Identifier: BSD-3-Clause
// Conical or flat ring whose inner rim has triangular teeth. The tips of the teeth lie on inner_radius, where the ring
// is placed, the valleys between them at inner_radius + tooth_depth; in between the radius of the rim is linear in
// azimuth. Keys: serrated_cone.cpp; page: docs/reference/shapes/serrated_cone.md.
#pragma once

#include "geometry/cone.hpp"
#include "geometry/roots.hpp"

namespace straytrace {

struct SerratedCone : Cone {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};
  double tooth_depth = 0.01, teeth = 100, phase = 0;  // m, measured across the axis; 1; rad, azimuth of a tip
  static constexpr char const* key = "serrated_cone";

  STRAY_HD void place(Pose const& pose) {
    Cone::place(pose);
    e1 = pose.e1;
    e2 = pose.e2;
    if (half_angle > pi / 2 - 1e-9) {  // flat
      sine = 1;
      cosine = 0;
      apex = origin;
    }
  }
  // Radius of the rim at an offset from the axis.
  STRAY_HD double rim(Vec3 across) const {
    double const x = (turn_of(dot(across, e1), dot(across, e2)) - phase / (2 * pi)) * teeth;
    return inner_radius + tooth_depth * (1 - std::fabs(1 - 2 * (x - std::floor(x))));
  }
  STRAY_HD bool on_teeth(Vec3 across) const {
    double const rho = length(across);
    return rho >= inner_radius + tooth_depth || rho >= rim(across);
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    if (cosine > 0) return first(r, leaving, [this](Vec3 at) { return on_teeth(at); });
    double const slope = dot(r.dir, axis);
    if (leaving || slope == 0) return infinity;
    Vec3 const o = r.origin - origin;
    double const t = -dot(o, axis) / slope;
    if (!(t > 0 && t < r.t_max)) return infinity;
    Vec3 const p = o + t * r.dir, across = p - dot(p, axis) * axis;
    return length(across) <= outer_radius && on_teeth(across) ? t : infinity;
  }
  // Integral of rim^2 over a part x of the way from tip to valley.
  STRAY_HD double squares(double x) const {
    return x * (inner_radius * inner_radius + tooth_depth * x * (inner_radius + tooth_depth * x / 3));
  }
  STRAY_HD double area() const { return pi * (outer_radius * outer_radius - squares(1)) / sine; }
  STRAY_HD Vec3 sample(double u, double v) const {
    double const outer2 = outer_radius * outer_radius, whole = outer2 - squares(1);
    double const flank = std::floor(2 * teeth * v), share = (2 * teeth * v - flank) * whole;
    auto const excess = [&](double x) {
      double const edge = inner_radius + tooth_depth * x;
      return Sloped{outer2 * x - squares(x) - share, outer2 - edge * edge};
    };
    double const x = bracketed_root(excess, 0, 1, true), edge = inner_radius + tooth_depth * x;
    bool const falling = flank - 2 * std::floor(0.5 * flank) == 1;  // from valley to tip
    SinCos const a = sincos_turn((flank + (falling ? 1 - x : x)) / (2 * teeth) + phase / (2 * pi));
    double const rho = std::sqrt(edge * edge + u * (outer2 - edge * edge));
    return apex + (rho * cosine / sine) * axis + (rho * a.cos) * e1 + (rho * a.sin) * e2;
  }
};

}  // namespace straytrace
