// SPDX-License-Identifier: BSD-3-Clause
// For every type in ShapeTypes: placed instances, a function that is zero on the surface, and a length scale. A shape
// without them does not compile here.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "base/rng.hpp"
#include "shapes.hpp"

namespace straytrace::testing {

template <class List>
struct TypesOf;
template <class... T>
struct TypesOf<std::tuple<T...>> {
  using type = ::testing::Types<T...>;
};
using AllShapes = TypesOf<ShapeTypes>::type;

// Along z, against z, tilted, and tilted far from the origin.
inline std::vector<Placement> placements() {
  return {{{0, 0, 0}, {0, 0, 1}},
          {{0.3, -0.2, 3000}, {0, 0, -1}},
          {{0, 0, 1}, unit({0.3, -0.5, 0.7})},
          {{12, -7, 40000}, unit({1, 0.02, 1e-3})}};
}

template <class Shape>
std::vector<Shape> instances();

template <class Shape>
std::vector<Shape> everywhere(std::vector<Shape> const& shapes) {
  std::vector<Shape> all;
  for (Placement const& where : placements())
    for (Shape const& s : shapes) all.push_back(placed(s, where));
  return all;
}
template <>
inline std::vector<Disk> instances() {
  return everywhere<Disk>({disk(0, 1), disk(0.4, 0.5), disk(1e-3, 0.17)});
}
template <>
inline std::vector<Cap> instances() {
  return everywhere<Cap>(
      {cap(0, 0, 0.2), cap(1 / 1683.0, 0, 0.175), cap(-1 / 25.0, 0.05, 0.2), cap(1, 0, 1 - 1e-9), cap(2, 0.1, 0.4)});
}
template <>
inline std::vector<Cylinder> instances() {
  return everywhere<Cylinder>({cylinder(1, 0, 2), cylinder(0.5, -1500, 1500), cylinder(0.17, -0.1, 0.1)});
}
template <>
inline std::vector<Cone> instances() {
  return everywhere<Cone>({cone(0, 1, pi / 4), cone(0.4, 0.5, 0.35), cone(0.4, 0.5, 1.5), cone(0.1, 0.6, 0.01)});
}
template <>
inline std::vector<Sphere> instances() {
  return everywhere<Sphere>({sphere(1), sphere(1e-3), sphere(1683)});
}

struct Axial {
  double height, radius;  // along and across the axis, from reference(), m
};
template <class Shape>
Axial axial(Shape const& s, Vec3 p) {
  Vec3 const o = p - s.reference();
  double const h = dot(o, s.axis);
  return {h, length(o - h * s.axis)};
}

// Zero on the surface, with unit gradient there, growing along the normal that the shape documents.
inline double implicit(Disk const& s, Vec3 p) { return dot(p - s.centre, s.axis); }
inline double implicit(Cap const& s, Vec3 p) {
  Vec3 const o = p - s.vertex;
  return dot(o, s.axis) - 0.5 * s.curvature * dot(o, o);
}
inline double implicit(Cylinder const& s, Vec3 p) { return axial(s, p).radius - s.radius; }
inline double implicit(Cone const& s, Vec3 p) {
  Axial const a = axial(s, p);
  return (a.radius - s.inner_radius) * std::cos(s.half_angle) - a.height * std::sin(s.half_angle);
}
inline double implicit(Sphere const& s, Vec3 p) { return length(p - s.centre) - s.radius; }

// Largest distance between points of the surface and the point its equations are written about, m.
inline double size(Disk const& s) { return s.outer_radius; }
inline double size(Cap const& s) { return s.outer_radius; }
inline double size(Cylinder const& s) { return std::fmax(s.radius, std::fmax(std::fabs(s.from), std::fabs(s.to))); }
inline double size(Cone const& s) { return s.outer_radius / std::sin(s.half_angle); }
inline double size(Sphere const& s) { return s.radius; }

class Directions {
 public:
  explicit Directions(std::uint64_t seed) : rng_(seed, 0, 0, Stream::source) {}
  double uniform() { return rng_.uniform(); }
  Vec3 direction() {
    double const z = 2 * rng_.uniform() - 1, r = std::sqrt(1 - z * z);
    SinCos const a = sincos_turn(rng_.uniform());
    return {r * a.cos, r * a.sin, z};
  }
  template <class Shape>
  Vec3 point(Shape const& s) {
    double const u = rng_.uniform(), v = rng_.uniform();
    return s.sample(u, v);
  }

 private:
  Rng rng_;
};

}  // namespace straytrace::testing
