// SPDX-License-Identifier: BSD-3-Clause
// For every type in ShapeTypes but meshes (tests/unit/geometry/mesh.cpp): placed instances, a function that is zero on
// the surface, and a length scale. A shape without them does not compile here.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "base/math/rng.hpp"
#include "support/cad_faces.hpp"
#include "support/shapes.hpp"

namespace straytrace::testing {

template <class List>
struct TypesOf;
template <class... T>
struct TypesOf<std::tuple<T...>> {
  using type = ::testing::Types<T...>;
};
template <class... T>
auto without_meshes(std::tuple<T...>*) -> decltype(std::tuple_cat(
    std::declval<std::conditional_t<std::is_same_v<T, TriangleMesh>, std::tuple<>, std::tuple<T>>>()...));
using AllShapes = TypesOf<decltype(without_meshes(static_cast<ShapeTypes*>(nullptr)))>::type;

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

template <>
inline std::vector<Conic> instances() {
  return everywhere<Conic>({conic(1, -1, 0, 0.8), conic(0.5, -1, 0, 0.3, 0.7), conic(-1 / 25.0, -2.5, 0.05, 0.2),
                            conic(2, 0.6, 0.1, 0.35), conic(0, 0, 0, 0.1), asphere(conic(1, -1, 0, 0.5), 0.3, -0.4),
                            asphere(conic(0, 0, 0.02, 0.3, 0.1), 2, 0, 30, -90),
                            asphere(conic(3, -0.4, 0, 0.2), -40, 300, 0, 1e4)});
}
template <>
inline std::vector<Rectangle> instances() {
  return everywhere<Rectangle>({rectangle(2, 0.7), rectangle(0.3, 0.5, 0.1, 0.45), rectangle(1, 1, 1, 0.2)});
}
template <>
inline std::vector<Ellipse> instances() {
  return everywhere<Ellipse>({ellipse(0.6, 0.2), ellipse(0.5, 0.5, 0.4, 0.1), ellipse(0.2, 0.4, 0.15, 0.3)});
}
template <>
inline std::vector<Polygon> instances() {
  return everywhere<Polygon>(
      {polygon(3, 1), polygon(6, 0.5, 6, 0.4), polygon(0, 0.4, 5, 0.3), polygon(8, 0.3, 0, 0.2)});
}
template <>
inline std::vector<Cuboid> instances() {
  return everywhere<Cuboid>({cuboid(1, 1, 1), cuboid(0.2, 3, 0.7), cuboid(5, 4, 0.01)});
}
template <>
inline std::vector<Torus> instances() {
  return everywhere<Torus>({torus(1, 0.3), torus(0.5, 0.01), torus(2, 1.9), torus(10, 0.01)});
}
template <>
inline std::vector<PiercedCylinder> instances() {
  return everywhere<PiercedCylinder>(
      {pierced(0.5, 0, 2, 0.2, 0.7), pierced(1, -1, 1, 0.3, 0.1, 8), pierced(0.17, -0.3, 0.3, 0.16, 0, 1)});
}
template <>
inline std::vector<SerratedCone> instances() {
  return everywhere<SerratedCone>(
      {serrated(0.4, 0.5, 0.6, 0.03, 12), serrated(0.2, 1, 1.2, 0.5, 3), serrated(0.5, 0.6, pi / 2, 0.05, 40)});
}
template <>
inline std::vector<CutCylinder> instances() {
  return everywhere<CutCylinder>({cut_cylinder(0.5, 0, 1, 0.7), cut_cylinder(0.2, -0.3, -0.05, -0.4)});
}
template <>
inline std::vector<Zone> instances() {
  return everywhere<Zone>({zone(1, -0.3, 0.9), zone(0.5, 0.1, 0.2), zone(2, -2, -1), zone(1683, 1682, 1683)});
}
template <>
inline std::vector<CadFace> instances() {
  return everywhere<CadFace>(cad_faces());
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
inline double implicit(PlaneFrame const& s, Vec3 p) { return dot(p - s.origin, s.axis); }
inline double implicit(Conic const& s, Vec3 p) {
  Vec3 const o = s.local(p - s.vertex);
  double const w = o.x * o.x + o.y * o.y, slope = 2 * s.steepness(w);
  return (o.z - s.sag(w)) / std::sqrt(1 + slope * slope * w);
}
inline double implicit(Torus const& s, Vec3 p) {
  Axial const a = axial(s, p);
  return std::hypot(a.radius - s.major_radius, a.height) - s.minor_radius;
}
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
inline double implicit(CadFace const& s, Vec3 p) {
  Axial const a = axial(s, p);
  switch (s.carrier) {
    case Carrier::plane:
      return s.sense * a.height;
    case Carrier::cylinder:
      return s.sense * (a.radius - s.radius);
    case Carrier::cone:
      return s.sense * (a.radius * std::cos(s.second) - a.height * std::sin(s.second));
    case Carrier::sphere:
      return s.sense * (length(p - s.pose.origin) - s.radius);
    case Carrier::torus:
      return s.sense * (std::hypot(a.radius - s.radius, a.height) - s.second);
  }
  return not_a_number;
}
template <class Shape>
double implicit(Shape const& s, Vec3 p, std::uint32_t) {
  return implicit(s, p);
}
inline double implicit(Cuboid const& s, Vec3 p, std::uint32_t face) {
  return dot(p - s.centre, s.normal(p, face)) - 0.5 * (face < 2 ? s.width : face < 4 ? s.height : s.depth);
}

// Largest distance between points of the surface and the point its equations are written about, m.
inline double size(Disk const& s) { return s.outer_radius; }
inline double size(Cap const& s) { return s.outer_radius; }
inline double size(Cylinder const& s) { return std::fmax(s.radius, std::fmax(std::fabs(s.from), std::fabs(s.to))); }
inline double size(Cone const& s) { return s.outer_radius / std::sin(s.half_angle); }
inline double size(Sphere const& s) { return s.radius; }
template <class Shape>
double size(Shape const& s) {
  auto const [low, high, r_min, r_max] = s.extent();
  return std::hypot(r_max, std::fmax(std::fabs(low), std::fabs(high)));
}

// Length over which the surface bends, m.
template <class Shape>
double feature(Shape const& s) {
  return axial(s, sample_of(s, 0.5, 0.5).point).radius;
}
inline double feature(Cuboid const& s) { return std::fmin(s.width, std::fmin(s.height, s.depth)); }
inline double feature(Rectangle const& s) { return s.width; }
inline double feature(CadFace const& s) {
  return s.carrier == Carrier::torus ? s.second : axial(s, s.sample(0.5, 0.5)).radius;
}
inline double feature(Torus const& s) { return s.minor_radius; }
inline double feature(Conic const& s) { return s.outer_radius / (1 + s.bend * s.outer_radius); }

// A shape as the contracts see it, with or without pieces; negative controls derive from it.
template <class Shape>
struct Seen {
  Shape s;
  Crossing cross(Ray const& r, bool leaving, std::uint32_t piece = 0) const {
    return crossing_of(s, r, leaving, piece);
  }
  Vec3 normal(SurfacePoint p) const { return normal_of(s, p.point, p.piece); }
  SurfacePoint project(SurfacePoint p) const { return {projected_on(s, p.point, p.piece), p.piece}; }
  Extent extent() const { return s.extent(); }
  Box bounds() const { return s.bounds(); }
};

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
  SurfacePoint point(Shape const& s) {
    double const u = rng_.uniform(), v = rng_.uniform();
    return sample_of(s, u, v);
  }

 private:
  Rng rng_;
};

}  // namespace straytrace::testing
