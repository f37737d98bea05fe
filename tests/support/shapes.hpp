// SPDX-License-Identifier: BSD-3-Clause
// Placed shapes in one line, for tests of geometry and search. Lengths in m, angles in rad.
#pragma once

#include "base/every_module.hpp"
#include "geometry/shape_types.hpp"

namespace straytrace::testing {

struct Placement {
  Vec3 at, along{0, 0, 1};
};

template <class Shape>
Shape placed(Shape shape, Placement where) {
  shape.place(facing_along(where.at, where.along));
  return shape;
}

inline Disk disk(double inner, double outer, Placement where = {}) {
  Disk s;
  s.inner_radius = inner;
  s.outer_radius = outer;
  return placed(s, where);
}
inline Cap cap(double curvature, double inner, double outer, Placement where = {}) {
  Cap s;
  s.curvature = curvature;
  s.inner_radius = inner;
  s.outer_radius = outer;
  return placed(s, where);
}
inline Cylinder cylinder(double radius, double from, double to, Placement where = {}) {
  Cylinder s;
  s.radius = radius;
  s.from = from;
  s.to = to;
  return placed(s, where);
}
inline Cone cone(double inner, double outer, double half_angle, Placement where = {}) {
  Cone s;
  s.inner_radius = inner;
  s.outer_radius = outer;
  s.half_angle = half_angle;
  return placed(s, where);
}
inline Sphere sphere(double radius, Placement where = {}) {
  Sphere s;
  s.radius = radius;
  return placed(s, where);
}

inline Conic conic(double curvature, double conic_constant, double inner, double outer, double decentre = 0) {
  Conic s;
  s.curvature = curvature;
  s.conic_constant = conic_constant;
  s.inner_radius = inner;
  s.outer_radius = outer;
  s.decentre_x = decentre;
  s.place({});
  return s;
}
inline Conic asphere(Conic s, double a4, double a6 = 0, double a8 = 0, double a10 = 0) {
  s.a4 = a4;
  s.a6 = a6;
  s.a8 = a8;
  s.a10 = a10;
  s.place({});
  return s;
}
inline Rectangle rectangle(double width, double height, double hole_width = 0, double hole_height = 0) {
  Rectangle s;
  s.width = width;
  s.height = height;
  s.hole_width = hole_width;
  s.hole_height = hole_height;
  return s;
}
inline Ellipse ellipse(double semi_x, double semi_y, double hole_x = 0, double hole_y = 0) {
  Ellipse s;
  s.semi_x = semi_x;
  s.semi_y = semi_y;
  s.hole_x = hole_x;
  s.hole_y = hole_y;
  return s;
}
inline Polygon polygon(double sides, double radius, double hole_sides = 0, double hole_radius = 0) {
  Polygon s;
  s.sides = sides;
  s.radius = radius;
  s.rotation = 0.2;
  s.hole_sides = hole_sides;
  s.hole_radius = hole_radius;
  s.hole_rotation = 0.2;
  s.place({});
  return s;
}
inline Cuboid cuboid(double width, double height, double depth, Placement where = {}) {
  Cuboid s;
  s.width = width;
  s.height = height;
  s.depth = depth;
  return placed(s, where);
}
inline Torus torus(double major, double minor, Placement where = {}) {
  Torus s;
  s.major_radius = major;
  s.minor_radius = minor;
  return placed(s, where);
}
inline PiercedCylinder pierced(double radius, double from, double to, double hole_radius, double height,
                               double holes = 1) {
  PiercedCylinder s;
  s.radius = radius;
  s.from = from;
  s.to = to;
  s.hole_radius = hole_radius;
  s.hole_height = height;
  s.holes = holes;
  s.place({});
  return s;
}
inline SerratedCone serrated(double inner, double outer, double half_angle, double depth, double teeth) {
  SerratedCone s;
  s.inner_radius = inner;
  s.outer_radius = outer;
  s.half_angle = half_angle;
  s.tooth_depth = depth;
  s.teeth = teeth;
  s.place({});
  return s;
}
inline CutCylinder cut_cylinder(double radius, double from, double to, double tilt) {
  CutCylinder s;
  s.radius = radius;
  s.from = from;
  s.end = to;
  s.tilt = tilt;
  s.place({});
  return s;
}
inline Zone zone(double radius, double from, double to, Placement where = {}) {
  Zone s;
  s.radius = radius;
  s.from = from;
  s.to = to;
  return placed(s, where);
}

}  // namespace straytrace::testing
