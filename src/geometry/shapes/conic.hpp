// SPDX-License-Identifier: BSD-3-Clause
// Conic or even asphere over a circular aperture that need not be centred: mirrors of telescopes, lens faces. Height
// over the plane at the vertex, w = squared distance from the axis:
//   s(w) = c w/(1 + sqrt(1 - (1 + k) c^2 w)) + a4 w^2 + a6 w^3 + a8 w^4 + a10 w^5
// Keys and preparation: conic.cpp; page: docs/reference/shapes/conic.md.
#pragma once

#include <span>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

struct Conic {
  Vec3 vertex, e1{1, 0, 0}, e2{0, 1, 0}, axis{0, 0, 1};  // m; the axis points to the centre of curvature for c > 0
  double curvature = 0, conic_constant = 0;              // c [1/m], k
  double a4 = 0, a6 = 0, a8 = 0, a10 = 0;                // 1/m^3, 1/m^5, 1/m^7, 1/m^9
  double inner_radius = 0, outer_radius = 1;             // m, of the aperture, about its own centre
  double decentre_x = 0, decentre_y = 0;                 // m, centre of the aperture along e1 and e2
  // Set by place(): area; bounds of the area per area of aperture, of |d2s| and |d3s| along a line; least and largest
  // s.
  double surface = 0, steepest = 1, bend = 0, twist = 0, lowest = 0, highest = 0;
  static constexpr char const* key = "conic";
  static constexpr bool hides_itself = true;  // with aspheric terms
  static std::span<Key<Conic> const> keys();
  ShapeComplaint impossible() const;
  SurfaceCurvature curvature_at(Vec3 p) const;
  Drawing drawing() const;

  void place(Pose const& pose);

  STRAY_HD bool pure() const { return a4 == 0 && a6 == 0 && a8 == 0 && a10 == 0; }
  STRAY_HD double root_of(double w) const {  // the square root in s(w); 0 beyond the equator
    return std::sqrt(std::fmax(0.0, 1 - (1 + conic_constant) * curvature * curvature * w));
  }
  STRAY_HD double sag(double w) const {
    return w * (curvature / (1 + root_of(w)) + w * (a4 + w * (a6 + w * (a8 + w * a10))));
  }
  STRAY_HD double steepness(double w) const {  // ds/dw
    return 0.5 * curvature / root_of(w) + w * (2 * a4 + w * (3 * a6 + w * (4 * a8 + w * 5 * a10)));
  }
  STRAY_HD Vec3 local(Vec3 v) const { return {dot(v, e1), dot(v, e2), dot(v, axis)}; }
  STRAY_HD Vec3 world(Vec3 v) const { return v.x * e1 + v.y * e2 + v.z * axis; }
  STRAY_HD bool in_aperture(double x, double y) const {
    double const dx = x - decentre_x, dy = y - decentre_y, r2 = dx * dx + dy * dy;
    return r2 >= inner_radius * inner_radius && r2 <= outer_radius * outer_radius;
  }

  STRAY_HD double distance(Ray const& r, bool leaving) const {
    Vec3 p = local(r.origin - vertex);
    Vec3 const d = local(r.dir);
    double near = 0;
    if (!leaving) {  // solve from the point nearest the vertex: no cancellation far away
      near = -dot(p, d);
      p = p + near * d;
    }
    return pure() ? conic_distance(p, d, near, leaving, r.t_max) : asphere_distance(p, d, near, leaving, r.t_max);
  }
  STRAY_HD double conic_distance(Vec3 p, Vec3 d, double near, bool leaving, double t_max) const {
    double const c = curvature, q = 1 + conic_constant;
    double const a = c * (d.x * d.x + d.y * d.y + q * d.z * d.z);
    double const b = c * (p.x * d.x + p.y * d.y + q * p.z * d.z) - d.z;
    auto const accept = [&](double s) {
      Vec3 const at = p + s * d;
      bool const there = near + s > 0 && near + s < t_max;
      return there && q * c * at.z < 1 && in_aperture(at.x, at.y) ? near + s : infinity;  // the half at the vertex
    };
    if (leaving) return a == 0 ? infinity : accept(-2 * b / a);
    double const e = c * (p.x * p.x + p.y * p.y + q * p.z * p.z) - 2 * p.z, square = b * b - a * e;
    if (square < 0) return infinity;
    double const s = -(b + std::copysign(std::sqrt(square), b));
    double const one = s == 0 ? infinity : e / s, two = a == 0 ? infinity : s / a;
    double const first = accept(one < two ? one : two);
    return first < infinity ? first : accept(one < two ? two : one);
  }
  // The part of the ray inside the cylinder over the aperture and between the heights of the surface is searched; when
  // leaving, f(s)/s, so that the root at 0 is gone.
  STRAY_HD double asphere_distance(Vec3 p, Vec3 d, double near, bool leaving, double t_max) const {
    double from = leaving ? 0 : std::fmax(-near, -1e9), to = 1e9;
    double const flat = d.x * d.x + d.y * d.y, x = p.x - decentre_x, y = p.y - decentre_y;
    double const pad = 1e-12 * outer_radius;
    if (flat > 0) {
      double const middle = -(x * d.x + y * d.y) / flat, across = (x * d.y - y * d.x);
      double const reach = outer_radius + pad, square = reach * reach - across * across / flat;
      if (square < 0) return infinity;
      from = std::fmax(from, middle - std::sqrt(square / flat));
      to = std::fmin(to, middle + std::sqrt(square / flat));
    } else if (x * x + y * y > outer_radius * outer_radius) {
      return infinity;
    }
    if (d.z != 0) {
      double const one = (lowest - pad - p.z) / d.z, two = (highest + pad - p.z) / d.z;
      from = std::fmax(from, one < two ? one : two);
      to = std::fmin(to, one < two ? two : one);
    }
    if (!(from < to)) return infinity;
    auto const keep = [&](double s) {
      Vec3 const at = p + s * d;
      return near + s > 0 && near + s < t_max && in_aperture(at.x, at.y);
    };
    auto const search = [&](auto const& f, double bound) {
      double const s = first_root(f, from, to, bound, 1e-10 * outer_radius, keep);
      return s < infinity ? near + s : infinity;
    };
    if (leaving) return search([&](double s) { return rest(p, d, s); }, twist / 3);
    return search([&](double s) { return off(p, d, s); }, bend);
  }
  STRAY_HD Sloped off(Vec3 p, Vec3 d, double s) const {  // height over the surface along the line
    double const x = p.x + s * d.x, y = p.y + s * d.y, w = x * x + y * y;
    return {p.z + s * d.z - sag(w), d.z - 2 * steepness(w) * (x * d.x + y * d.y)};
  }
  // off(s)/s for a point p on the surface, from the divided difference of s(w), which does not cancel.
  STRAY_HD Sloped rest(Vec3 p, Vec3 d, double s) const {
    double const w0 = p.x * p.x + p.y * p.y, b = p.x * d.x + p.y * d.y, a = d.x * d.x + d.y * d.y;
    double const w = std::fmax(0.0, w0 + s * (2 * b + a * s)), dw = 2 * b + 2 * a * s;
    double const e0 = root_of(w0), e = root_of(w), c = curvature, sum = e + e0;
    double slant = c / sum, slant_w = (1 + conic_constant) * c * c * c / (2 * e * sum * sum);
    double const higher[4] = {a4, a6, a8, a10};
    double powers = w + w0, powers_w = 1, last = w0;  // (w^n - w0^n)/(w - w0), its derivative, w0^(n-1)
    for (double const coefficient : higher) {
      slant += coefficient * powers;
      slant_w += coefficient * powers_w;
      last *= w0;
      powers_w = powers + w * powers_w;
      powers = w * powers + last;
    }
    double const rise = 2 * b + a * s;
    return {d.z - rise * slant, -a * slant - rise * slant_w * dw};
  }
  // Gradient of the height over the surface, or of (c/2) (w + (1 + k) z^2) - z with the other sign.
  STRAY_HD Vec3 gradient(Vec3 p) const {
    if (pure()) return {-curvature * p.x, -curvature * p.y, 1 - (1 + conic_constant) * curvature * p.z};
    double const slope = 2 * steepness(p.x * p.x + p.y * p.y);
    return {-slope * p.x, -slope * p.y, 1};
  }
  STRAY_HD Vec3 normal(Vec3 p) const { return world(unit(gradient(local(p - vertex)))); }
  STRAY_HD Vec3 project(Vec3 p) const {  // one Newton step back onto the surface
    Vec3 const o = local(p - vertex), g = gradient(o);
    double const w = o.x * o.x + o.y * o.y;
    double const height = pure() ? o.z - 0.5 * curvature * (w + (1 + conic_constant) * o.z * o.z) : o.z - sag(w);
    return p - (height / length2(g)) * world(g);
  }
  STRAY_HD double area() const { return surface; }
  STRAY_HD Vec3 sample(double u, double v) const {  // even on the aperture, kept in proportion to the slope
    Redraw more(u, v);
    double const inner2 = inner_radius * inner_radius;
    for (;;) {
      double const rho = std::sqrt(inner2 + u * (outer_radius * outer_radius - inner2));
      SinCos const a = sincos_turn(v);
      double const x = decentre_x + rho * a.cos, y = decentre_y + rho * a.sin, w = x * x + y * y;
      double const slope = 2 * steepness(w);
      if (more.next() * steepest <= std::sqrt(1 + slope * slope * w)) return vertex + world({x, y, sag(w)});
      u = more.next();
      v = more.next();
    }
  }
  STRAY_HD double decentre() const { return std::sqrt(decentre_x * decentre_x + decentre_y * decentre_y); }
  STRAY_HD Extent extent() const {
    double const off_axis = decentre();
    return {lowest, highest, std::fmax(0.0, std::fmax(off_axis - outer_radius, inner_radius - off_axis)),
            off_axis + outer_radius};
  }
  STRAY_HD Vec3 reference() const { return vertex; }
  // Two boxes hold the surface: that of the cylinder between its heights, and that of the tangent plane over the
  // aperture with the deviation from it, which a pure conic has on one side only.
  STRAY_HD Box bounds() const {
    Box const tall = box_about_axis(vertex + decentre_x * e1 + decentre_y * e2, axis, lowest, highest, outer_radius);
    double const w = decentre_x * decentre_x + decentre_y * decentre_y, slope = 2 * steepness(w);
    Vec3 const middle = vertex + world({decentre_x, decentre_y, sag(w)});
    Vec3 const a = e1 + (slope * decentre_x) * axis, b = e2 + (slope * decentre_y) * axis;
    double const most = 0.5 * bend * outer_radius * outer_radius;
    double const below = pure() && curvature >= 0 ? 0 : -most, above = pure() && curvature <= 0 ? 0 : most;
    Vec3 const side{outer_radius * std::sqrt(a.x * a.x + b.x * b.x), outer_radius * std::sqrt(a.y * a.y + b.y * b.y),
                    outer_radius * std::sqrt(a.z * a.z + b.z * b.z)};
    Box flat{middle + below * axis - side, middle + below * axis + side};
    flat.add(Box{middle + above * axis - side, middle + above * axis + side});
    return {{std::fmax(tall.lower.x, flat.lower.x), std::fmax(tall.lower.y, flat.lower.y),
             std::fmax(tall.lower.z, flat.lower.z)},
            {std::fmin(tall.upper.x, flat.upper.x), std::fmin(tall.upper.y, flat.upper.y),
             std::fmin(tall.upper.z, flat.upper.z)}};
  }
};

}  // namespace straytrace::geometry
