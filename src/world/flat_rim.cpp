// SPDX-License-Identifier: BSD-3-Clause
#include "world/flat_rim.hpp"

#include <algorithm>
#include <type_traits>

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

}  // namespace straytrace
