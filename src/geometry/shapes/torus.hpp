// SPDX-License-Identifier: BSD-3-Clause
// Ring torus: bellows, round edges. Keys: torus.cpp; page: docs/reference/shapes/torus.md.
#pragma once

#include <span>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

struct Torus {
  Vec3 centre, axis{0, 0, 1};                    // m; unit axis of the ring
  double major_radius = 1, minor_radius = 0.25;  // m: of the circle that the tube runs along, and of the tube
  static constexpr char const* key = "torus";
  static constexpr bool hides_itself = true;
  static std::span<Key<Torus> const> keys();
  ShapeComplaint impossible() const;
  SurfaceCurvature curvature_at(Vec3 p) const;
  Drawing drawing() const;

  STRAY_HD void place(Pose const& pose) {
    centre = pose.origin;
    axis = pose.e3;
  }
  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return first(r, leaving, [](Vec3) { return true; });
  }
  // First hit for which keep(position relative to the centre) holds.
  template <class Keep>
  STRAY_HD double first(Ray const& r, bool leaving, Keep const& keep) const {
    return leaving ? other_root(r, keep) : first_of_four(r, keep);
  }

  // x^3 + c2 x^2 + c1 x + c0
  struct Cubic {
    double c2, c1, c0;
    STRAY_HD Sloped operator()(double x) const { return {((x + c2) * x + c1) * x + c0, (3 * x + 2 * c2) * x + c1}; }
    // Where it changes sign between low and high, in rising order: between its turning points it is monotone.
    STRAY_HD int roots(double low, double high, double* x) const {
      double stop[4] = {low, high, high, high};
      double const square = c2 * c2 - 3 * c1;
      if (square > 0) {
        double const q = -(c2 + std::copysign(std::sqrt(square), c2));
        double const one = q / 3, two = c1 / q;
        stop[1] = std::fmin(high, std::fmax(low, one < two ? one : two));
        stop[2] = std::fmin(high, std::fmax(low, one < two ? two : one));
      }
      int found = 0;
      double left = (*this)(low).value;
      if (left == 0) left = (*this)(low).slope;
      for (int i = 0; i < 3; ++i) {
        double const right = (*this)(stop[i + 1]).value;
        if ((left < 0) != (right < 0)) x[found++] = bracketed_root(*this, stop[i], stop[i + 1], left < 0);
        left = right;
      }
      return found;
    }
  };
  // With s from the point nearest the centre the quartic has no cubic term; its turning points are roots of a cubic and
  // enclose its roots. Signs are taken from the distance to the tube, which does not cancel.
  template <class Keep>
  STRAY_HD double first_of_four(Ray const& r, Keep const& keep) const {
    Vec3 const o = r.origin - centre;
    double const near = -dot(o, r.dir);
    Vec3 const q = o + near * r.dir;
    double const ring = major_radius, reach = ring + minor_radius, qz = dot(q, axis), dz = dot(r.dir, axis);
    if (length2(q) > reach * reach) return infinity;
    Vec3 const qp = q - qz * axis, dp = r.dir - dz * axis;
    double const k = length2(q) + (ring - minor_radius) * reach;
    double stop[5] = {-reach};
    int const n =
        1 + Cubic{0, k - 2 * ring * ring * length2(dp), -2 * ring * ring * dot(qp, dp)}.roots(-reach, reach, stop + 1);
    stop[n] = reach;
    auto const off = [&](double s) {
      Vec3 const p = qp + s * dp;
      double const z = qz + s * dz, rho = length(p);
      return Sloped{(rho - ring) * (rho - ring) + z * z - minor_radius * minor_radius,
                    2 * (rho - ring) * dot(p, dp) / rho + 2 * z * dz};
    };
    double left = off(stop[0]).value;
    for (int i = 0; i < n; ++i) {
      double const right = off(stop[i + 1]).value;
      if ((left < 0) != (right < 0)) {
        double const t = near + bracketed_root(off, stop[i], stop[i + 1], left < 0);
        if (t > 0 && t < r.t_max && keep(o + t * r.dir)) return t;
      }
      left = right;
    }
    return infinity;
  }
  // On the surface one root is 0: a cubic is left, whose constant term is the slope against the surface.
  template <class Keep>
  STRAY_HD double other_root(Ray const& r, Keep const& keep) const {
    Vec3 const o = r.origin - centre;
    double const ring = major_radius, oz = dot(o, axis), dz = dot(r.dir, axis), b = dot(o, r.dir);
    Vec3 const op = o - oz * axis;
    double const rho = length(op), flat = 1 - dz * dz;
    double const slope = dot(o - (ring / rho) * op, r.dir);
    double x[3];
    int const n = Cubic{4 * b, 4 * b * b + 4 * ring * rho - 4 * ring * ring * flat, 8 * ring * rho * slope}.roots(
        0, 2.0001 * (ring + minor_radius), x);
    for (int i = 0; i < n && x[i] > 0 && x[i] < r.t_max; ++i)
      if (keep(o + x[i] * r.dir)) return x[i];
    return infinity;
  }
  STRAY_HD Vec3 from_ring(Vec3 p) const {  // from the nearest point of the circle within the tube
    Vec3 const o = p - centre, op = o - dot(o, axis) * axis;
    return o - (major_radius / length(op)) * op;
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return unit(from_ring(p)); }  // out of the tube
  STRAY_HD Vec3 project(Vec3 p) const {
    Vec3 const w = from_ring(p);
    double const off = length(w);
    return p + ((minor_radius - off) / off) * w;
  }
  STRAY_HD double area() const { return 4 * pi * pi * major_radius * minor_radius; }
  STRAY_HD Vec3 sample(double u, double v) const {  // around the tube the density is 1 + (r/R) cos
    double const ratio = minor_radius / major_radius;
    auto const share = [&](double x) {
      SinCos const a = sincos_turn(x);
      return Sloped{x + ratio * a.sin / (2 * pi) - u, 1 + ratio * a.cos};
    };
    SinCos const tube = sincos_turn(bracketed_root(share, 0, 1, true)), ring = sincos_turn(v);
    double const rho = major_radius + minor_radius * tube.cos;
    Frame const f = Frame::around(axis);
    return centre + (rho * ring.cos) * f.e1 + (rho * ring.sin) * f.e2 + (minor_radius * tube.sin) * axis;
  }
  STRAY_HD Extent extent() const {
    return {-minor_radius, minor_radius, major_radius - minor_radius, major_radius + minor_radius};
  }
  STRAY_HD Vec3 reference() const { return centre; }
  // m: across the ring rounding of the slope, which is that of the tube, counts as it does on a surface of this size.
  double largest_length() const { return major_radius * major_radius / minor_radius; }
  STRAY_HD Box bounds() const {
    Box const ring = box_about_axis(centre, axis, 0, 0, major_radius);
    Vec3 const tube{minor_radius, minor_radius, minor_radius};
    return {ring.lower - tube, ring.upper + tube};
  }
};

}  // namespace straytrace::geometry
