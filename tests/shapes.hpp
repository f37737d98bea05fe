// SPDX-License-Identifier: BSD-3-Clause
// Placed shapes in one line, for tests of geometry and search. Lengths in m, angles in rad.
#pragma once

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

}  // namespace straytrace::testing
