// SPDX-License-Identifier: BSD-3-Clause
// Flat shapes: disk, ellipse, rectangle, polygon, with or without a hole. Keys: flat.cpp.
#pragma once

#include <span>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

// A plane with two directions in it.
struct PlaneFrame {
  Vec3 origin, e1{1, 0, 0}, e2{0, 1, 0}, axis{0, 0, 1};  // m; unit vectors, axis is the normal

  STRAY_HD void place(Pose const& pose) {
    origin = pose.origin;
    e1 = pose.e1;
    e2 = pose.e2;
    axis = pose.e3;
  }
  // Distance to the plane where `inside(x, y)` holds at the hit; a plane is left for good.
  template <class Inside>
  STRAY_HD double meet(Ray const& r, bool leaving, Inside const& inside) const {
    double const slope = dot(r.dir, axis);
    if (leaving || slope == 0) return infinity;
    Vec3 const o = r.origin - origin;
    double const t = -dot(o, axis) / slope;
    if (!(t > 0 && t < r.t_max)) return infinity;
    Vec3 const p = o + t * r.dir;
    return inside(dot(p, e1), dot(p, e2)) ? t : infinity;
  }
  STRAY_HD Vec3 normal(Vec3) const { return axis; }
  STRAY_HD Vec3 project(Vec3 p) const { return p - dot(p - origin, axis) * axis; }
  STRAY_HD Vec3 at(double x, double y) const { return origin + x * e1 + y * e2; }
  STRAY_HD Vec3 reference() const { return origin; }
};

// Flat disk or annulus: flat baffles, end plates, flat optics. Page: docs/reference/shapes/disk.md.
struct Disk {
  Vec3 centre, axis{0, 0, 1};                 // m; unit normal
  double inner_radius = 0, outer_radius = 1;  // m
  static constexpr char const* key = "disk";
  static constexpr std::uint32_t drawn_rows = 1;
  static std::span<Key<Disk> const> keys();
  ShapeComplaint impossible() const;

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
  STRAY_HD Extent extent() const { return {0, 0, inner_radius, outer_radius}; }
  STRAY_HD Vec3 reference() const { return centre; }
  STRAY_HD Box bounds() const { return box_about_axis(centre, axis, 0, 0, outer_radius); }
};

// Elliptic disk, with or without an elliptic hole. Page: docs/reference/shapes/ellipse.md.
struct Ellipse : PlaneFrame {
  double semi_x = 1, semi_y = 1;  // m, semi-axes along e1 and e2
  double hole_x = 0, hole_y = 0;  // m, semi-axes of the hole
  static constexpr char const* key = "ellipse";
  static std::span<Key<Ellipse> const> keys();
  ShapeComplaint impossible() const;
  Drawing drawing() const;

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
  STRAY_HD Extent extent() const { return {0, 0, std::fmin(hole_x, hole_y), std::fmax(semi_x, semi_y)}; }
  STRAY_HD Box bounds() const {
    Vec3 const a = semi_x * e1, b = semi_y * e2;
    Vec3 const side{std::sqrt(a.x * a.x + b.x * b.x), std::sqrt(a.y * a.y + b.y * b.y),
                    std::sqrt(a.z * a.z + b.z * b.z)};
    return {origin - side, origin + side};
  }
};

// Rectangle, with or without a rectangular hole. Page: docs/reference/shapes/rectangle.md.
struct Rectangle : PlaneFrame {
  double width = 1, height = 1;            // m, full sizes along e1 and e2
  double hole_width = 0, hole_height = 0;  // m
  static constexpr char const* key = "rectangle";
  static std::span<Key<Rectangle> const> keys();
  ShapeComplaint impossible() const;
  Drawing drawing() const;

  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return meet(r, leaving, [this](double x, double y) {
      double const two_x = 2 * std::fabs(x), two_y = 2 * std::fabs(y);
      return two_x <= width && two_y <= height && !(two_x < hole_width && two_y < hole_height);
    });
  }
  STRAY_HD double area() const { return width * height - hole_width * hole_height; }
  // Bars of full height left and right of the hole, then bars of the width of the hole below and above it.
  STRAY_HD Vec3 sample(double u, double v) const {
    double const bars = (width - hole_width) * height, s = u * area();
    if (s < bars || hole_width == 0) {
      double const x = s / height;
      return at(x - 0.5 * width + (2 * x < width - hole_width ? 0 : hole_width), (v - 0.5) * height);
    }
    double const y = (s - bars) / hole_width;
    return at((v - 0.5) * hole_width, y - 0.5 * height + (2 * y < height - hole_height ? 0 : hole_height));
  }
  STRAY_HD Extent extent() const {
    return {0, 0, 0.5 * std::fmin(hole_width, hole_height), 0.5 * std::sqrt(width * width + height * height)};
  }
  STRAY_HD Box bounds() const {
    Vec3 const a = 0.5 * width * e1, b = 0.5 * height * e2;
    Vec3 const side{std::fabs(a.x) + std::fabs(b.x), std::fabs(a.y) + std::fabs(b.y), std::fabs(a.z) + std::fabs(b.z)};
    return {origin - side, origin + side};
  }
};

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

// Regular polygon or circle, with or without a hole of the same kinds: apertures of blades. Page:
// docs/reference/shapes/polygon.md.
struct Polygon : PlaneFrame {
  double sides = 6, radius = 1, rotation = 0;                 // 1, m, rad
  double hole_sides = 0, hole_radius = 0, hole_rotation = 0;  // 1, m, rad
  double apothem = 1, hole_apothem = 0;                       // m, set by place()
  static constexpr char const* key = "polygon";
  static std::span<Key<Polygon> const> keys();
  ShapeComplaint impossible() const;
  Drawing drawing() const;

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
  STRAY_HD Extent extent() const { return {0, 0, hole_apothem, radius}; }
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

}  // namespace straytrace::geometry
