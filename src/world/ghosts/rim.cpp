// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/rim.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "beams/aperture.hpp"
#include "beams/mode.hpp"
#include "world/ghosts/beam_tree.hpp"

namespace straytrace {
namespace {

Stripe inside_ellipse(PlanePoint p, PlanePoint v) {  // of the unit circle
  double const a = v.x * v.x + v.y * v.y, b = p.x * v.x + p.y * v.y, c = p.x * p.x + p.y * p.y - 1;
  double const square = b * b - a * c;
  if (!(square > 0) || a == 0) return {0, a == 0 && c < 0 ? infinity : 0};
  double const q = -(b + std::copysign(std::sqrt(square), b)), one = q / a, two = c / q;
  return {std::max(0.0, std::min(one, two)), std::max(0.0, std::max(one, two))};
}
// Stays on the inner side of the line n.x = a.
void cut(Stripe& s, PlanePoint p, PlanePoint v, PlanePoint n, double a) {
  double const room = a - (n.x * p.x + n.y * p.y), speed = n.x * v.x + n.y * v.y;
  if (speed > 0) s.to = std::min(s.to, room / speed);
  if (speed < 0) s.from = std::max(s.from, room / speed);
  if (speed == 0 && room < 0) s.to = 0;
}

Outline circle(double radius) { return {radius, radius}; }
Outline outline_of(RegularOutline const& o) {
  return o.sides == 0 ? circle(o.radius) : Outline{o.radius, o.radius, o.sides, o.rotation, o.apothem};
}

FlatRim about(Vec3 centre, Vec3 axis, double inner, double outer) {
  Frame const f = Frame::around(axis);
  return {centre, f.e1, f.e2, axis, circle(outer), circle(inner), inner > 0};
}
FlatRim in_plane(PlaneFrame const& s, Outline const& outer, Outline const& inner, bool hole) {
  return {s.origin, s.e1, s.e2, s.axis, outer, inner, hole};
}

template <class Shape>
std::vector<FlatRim> rim_of_shape(Shape const&) {
  return {};
}
std::vector<FlatRim> rim_of_shape(Disk const& s) { return {about(s.centre, s.axis, s.inner_radius, s.outer_radius)}; }
std::vector<FlatRim> rim_of_shape(Cap const& s) {
  double const rim = s.inner_radius > 0 ? s.inner_radius : s.outer_radius;
  return {about(s.vertex + (s.curvature * s.depth(rim)) * s.axis, s.axis, s.inner_radius, s.outer_radius)};
}
std::vector<FlatRim> rim_of_shape(Conic const& s) {
  double const rim = (s.inner_radius > 0 ? s.inner_radius : s.outer_radius) + s.decentre();
  return {about(s.vertex + s.decentre_x * s.e1 + s.decentre_y * s.e2 + s.sag(rim * rim) * s.axis, s.axis,
                s.inner_radius, s.outer_radius)};
}
std::vector<FlatRim> rim_of_shape(Rectangle const& s) {
  return {in_plane(s, {s.width / 2, s.height / 2, 4, 0, 0, true}, {s.hole_width / 2, s.hole_height / 2, 4, 0, 0, true},
                   s.hole_width > 0 && s.hole_height > 0)};
}
std::vector<FlatRim> rim_of_shape(Ellipse const& s) {
  return {in_plane(s, {s.semi_x, s.semi_y}, {s.hole_x, s.hole_y}, s.hole_x > 0)};
}
std::vector<FlatRim> rim_of_shape(Polygon const& s) {
  return {in_plane(s, outline_of(s.outline()), outline_of(s.hole()), s.hole_radius > 0)};
}

std::vector<FlatRim> rim_of_shape(Cuboid const& s) {
  std::vector<FlatRim> faces;
  auto const add = [&](Vec3 n, Vec3 a, Vec3 b, double away, double width, double height) {
    for (double side : {-0.5, 0.5})
      faces.push_back({s.centre + (side * away) * n, a, b, n, {width / 2, height / 2, 4, 0, 0, true}, {}, false});
  };
  add(s.e1, s.e2, s.axis, s.width, s.height, s.depth);
  add(s.e2, s.axis, s.e1, s.height, s.depth, s.width);
  add(s.axis, s.e1, s.e2, s.depth, s.width, s.height);
  return faces;
}

}  // namespace

Stripe Outline::inside(PlanePoint p, PlanePoint v) const {
  if (sides == 0) return inside_ellipse({p.x / semi_x, p.y / semi_y}, {v.x / semi_x, v.y / semi_y});
  Stripe s;
  for (double k = 0; k < sides; ++k) {
    if (rectangle) {
      bool const x = k < 2;
      double const sign = int(k) % 2 == 0 ? 1 : -1;
      cut(s, p, v, {x ? sign : 0, x ? 0 : sign}, x ? semi_x : semi_y);
    } else {
      double const middle = rotation + 2 * pi * (k + 0.5) / sides;
      cut(s, p, v, {std::cos(middle), std::sin(middle)}, apothem);
    }
  }
  return s.empty() ? Stripe{0, 0} : s;
}

Stripes FlatRim::met(Vec3 start, Vec3 step, Vec3 travel) const {
  double const slope = dot(travel, axis);
  Vec3 const p = start - centre - (dot(start - centre, axis) / slope) * travel,
             v = step - (dot(step, axis) / slope) * travel;
  PlanePoint const at{dot(p, e1), dot(p, e2)}, by{dot(v, e1), dot(v, e2)};
  Stripe const within = outer.inside(at, by);
  if (within.empty()) return {};
  if (!hole) return {within};
  Stripe const open = inner.inside(at, by);
  return open.empty() ? Stripes{within} : without({within}, {open});
}

std::vector<FlatRim> flat_rims(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return rim_of_shape(s); });
}

// How much of a beam passes beside the surface that its chief ray meets (docs/theory/beams.md, eq. 5.5, 5.6).

namespace {

constexpr double reach = 4.5;             // radii: beyond lies exp(-2 reach^2) = 3e-18 of the power
constexpr double flat_rim_cosine = 0.02;  // cosine of incidence below which a rim is not taken as flat
constexpr int azimuths = 64, rings = 32, halvings = 40;

// Largest 1/e^2 radius, m.
double widest(Mode const& m) {
  auto const size = eigenvalues(m.q11.imag(), m.q12.imag(), m.q22.imag());
  return std::sqrt(m.wavelength / (pi * std::min(size[0], size[1])));
}

// Round rims: the circle about a point of the axis.
struct Rim {
  Vec3 centre, axis;
  double inner = 0, outer = 0;  // m
};
double beside_round(Rim const& rim, Mode const& mode) {
  double const cosine = std::fabs(dot(mode.travel, rim.axis)), far = reach * widest(mode) / cosine;
  Vec3 const o = mode.origin + (dot(rim.centre - mode.origin, rim.axis) / dot(mode.travel, rim.axis)) * mode.travel;
  double const off = length(o - rim.centre);
  double share = off + far < rim.outer ? 0 : clipped_share(Aperture{rim.centre, rim.axis, rim.outer}, mode);
  if (rim.inner > 0 && off - far < rim.inner)
    share += std::max(0.0, 1 - clipped_share(Aperture{rim.centre, rim.axis, rim.inner}, mode));
  return std::min(share, 1.0);
}

// Any shape: which lines parallel to the chief ray miss it, in polar coordinates in which the beam is round.
class Scan {
 public:
  Scan(WorldView const& world, SurfaceId surface, Mode const& mode) : world_(world), surface_(surface), mode_(mode) {
    double const k = pi / mode.wavelength, a = k * mode.q11.imag(), b = k * mode.q12.imag(), c = k * mode.q22.imag();
    double const root = std::sqrt(a), rest = std::sqrt(c - b * b / a);  // rho^2 = (root x + b/root y)^2 + (rest y)^2
    across_ = (1 / root) * mode.e1;
    up_ = (1 / rest) * (mode.e2 - (b / a) * mode.e1);
    Box const box = world.shapes.visit(world.surfaces[surface.value].shape, [](auto const& s) { return s.bounds(); });
    back_ = length(box.upper - box.lower) + length(mode.origin - box.lower);
  }
  double beside() const {
    if (all_meet()) return 0;
    double sum = 0;
    for (int i = 0; i < azimuths; ++i) sum += along((i + 0.5) / azimuths);
    return sum / azimuths;
  }

 private:
  bool meets(Vec3 direction, double rho) const {
    Ray const line{mode_.origin + rho * direction - back_ * mode_.travel, mode_.travel};
    return world_.cross(surface_.value, line, {}).distance < infinity;
  }
  Vec3 towards(double turn) const {
    SinCos const a = sincos_turn(turn);
    return a.cos * across_ + a.sin * up_;
  }
  bool all_meet() const {
    for (int i = 0; i < 16; ++i)
      for (double rho : {reach, 0.5 * reach})
        if (!meets(towards(i / 16.0), rho)) return false;
    return true;
  }
  static double beyond(double rho) { return std::exp(-2 * rho * rho); }
  double along(double turn) const {
    Vec3 const direction = towards(turn);
    double missed = 0, last = 0;
    bool before = true;  // the chief ray meets it
    for (int i = 1; i <= rings; ++i) {
      double const rho = reach * i / rings;
      bool const now = meets(direction, rho);
      if (now != before) {
        double low = last, high = rho;
        for (int h = 0; h < halvings; ++h) {
          double const middle = 0.5 * (low + high);
          (meets(direction, middle) == before ? low : high) = middle;
        }
        missed += (before ? 1 : -1) * beyond(high);
        before = now;
      }
      last = rho;
    }
    return missed;
  }

  WorldView const& world_;
  SurfaceId surface_;
  Mode const& mode_;
  Vec3 across_, up_;
  double back_ = 0;
};

template <class Shape>
bool round_rim(Shape const&, Rim&) {
  return false;
}
bool round_rim(Disk const& s, Rim& rim) {
  rim = {s.centre, s.axis, s.inner_radius, s.outer_radius};
  return true;
}
bool round_rim(Cap const& s, Rim& rim) {
  rim = {s.vertex + (s.curvature * s.depth(s.outer_radius)) * s.axis, s.axis, s.inner_radius, s.outer_radius};
  return true;
}
bool round_rim(Conic const& s, Rim& rim) {
  double const r = s.outer_radius + s.decentre();
  rim = {s.vertex + s.decentre_x * s.e1 + s.decentre_y * s.e2 + s.sag(r * r) * s.axis, s.axis, s.inner_radius,
         s.outer_radius};
  return true;
}

}  // namespace

double beside_rim(WorldView const& world, SurfaceId surface, Mode const& mode) {
  Rim rim;
  bool const flat =
      world.shapes.visit(world.surfaces[surface.value].shape, [&](auto const& s) { return round_rim(s, rim); });
  if (flat && std::fabs(dot(mode.travel, rim.axis)) > flat_rim_cosine) return beside_round(rim, mode);
  return Scan(world, surface, mode).beside();
}

}  // namespace straytrace
