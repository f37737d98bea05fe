// SPDX-License-Identifier: BSD-3-Clause
// Closed box of six faces; a face is a piece (pieces.hpp): 0 and 1 at -width/2 and +width/2 along e1, 2 and 3 along e2,
// 4 and 5 along the axis. Keys: cuboid.cpp; page: docs/reference/shapes/box.md.
#pragma once

#include <span>

#include "base/math/vec3.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::geometry {

struct Cuboid {
  Vec3 centre, e1{1, 0, 0}, e2{0, 1, 0}, axis{0, 0, 1};  // m; unit vectors
  double width = 1, height = 1, depth = 1;               // m, full sizes along e1, e2, axis
  static constexpr char const* key = "box";
  static std::span<Key<Cuboid> const> keys();
  Drawing drawing() const;
  static constexpr bool has_pieces = true;

  STRAY_HD void place(Pose const& pose) {
    centre = pose.origin;
    e1 = pose.e1;
    e2 = pose.e2;
    axis = pose.e3;
  }
  // Slabs. On a face the distance to its plane is 0 exactly, so that a ray either leaves for good or crosses the box;
  // one that starts inwards on an edge comes out there, at the smallest positive distance.
  STRAY_HD Crossing crossing(Ray const& r, std::uint32_t leaving) const {
    Vec3 const o = r.origin - centre, d = r.dir;
    double const at[3] = {dot(o, e1), dot(o, e2), dot(o, axis)}, dir[3] = {dot(d, e1), dot(d, e2), dot(d, axis)};
    double const half[3] = {0.5 * width, 0.5 * height, 0.5 * depth};
    bool inwards = false;
    if (leaving != no_piece) {
      std::uint32_t const i = leaving >> 1;
      inwards = leaving & 1 ? dir[i] < 0 : dir[i] > 0;
      if (!inwards) return {infinity, 0};
    }
    double entry = -infinity, exit = infinity;
    std::uint32_t entered = 0, left = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (dir[i] == 0) {
        if (!inwards && std::fabs(at[i]) > half[i]) return {infinity, 0};
        continue;
      }
      bool const up = dir[i] > 0;
      std::uint32_t const near_face = 2 * i + (up ? 0 : 1), far_face = near_face ^ 1;
      double const near = ((up ? -half[i] : half[i]) - at[i]) / dir[i];
      double const far = ((up ? half[i] : -half[i]) - at[i]) / dir[i];
      if (near > entry) {
        entry = near;
        entered = near_face;
      }
      if (far < exit) {
        exit = far;
        left = far_face;
      }
    }
    if (inwards) return within(exit > 0 ? exit : 0x1p-1022, left, r);
    if (!(entry <= exit)) return {infinity, 0};
    return entry > 0 ? within(entry, entered, r) : within(exit, left, r);
  }
  STRAY_HD static Crossing within(double t, std::uint32_t face, Ray const& r) {
    return t > 0 && t < r.t_max ? Crossing{t, face} : Crossing{infinity, 0};
  }
  STRAY_HD Vec3 normal(Vec3, std::uint32_t face) const {  // outwards
    Vec3 const n = face < 2 ? e1 : face < 4 ? e2 : axis;
    return face & 1 ? n : -n;
  }
  STRAY_HD Vec3 project(Vec3 p, std::uint32_t face) const {
    double const half = 0.5 * (face < 2 ? width : face < 4 ? height : depth);
    Vec3 const n = normal(p, face);
    return p + (half - dot(p - centre, n)) * n;
  }
  STRAY_HD double area() const { return 2 * (width * height + height * depth + depth * width); }
  STRAY_HD SurfacePoint sample(double u, double v) const {
    double const faces[3] = {2 * height * depth, 2 * depth * width, 2 * width * height};
    double const size[3] = {width, height, depth};
    double s = u * area();
    std::uint32_t i = 0;
    while (i < 2 && s >= faces[i]) s -= faces[i++];
    double x = 2 * s / faces[i];
    bool const upper = x >= 1;
    x -= upper ? 1 : 0;
    Vec3 const e[3] = {e1, e2, axis};
    std::uint32_t const j = (i + 1) % 3, k = (i + 2) % 3;
    Vec3 const p = centre + ((upper ? 0.5 : -0.5) * size[i]) * e[i] + ((x - 0.5) * size[j]) * e[j];
    return {p + ((v - 0.5) * size[k]) * e[k], 2 * i + (upper ? 1 : 0)};
  }
  STRAY_HD Extent extent() const {
    return {-0.5 * depth, 0.5 * depth, 0, 0.5 * std::sqrt(width * width + height * height)};
  }
  STRAY_HD Vec3 reference() const { return centre; }
  STRAY_HD Box bounds() const {
    Vec3 const a = 0.5 * width * e1, b = 0.5 * height * e2, c = 0.5 * depth * axis;
    Vec3 const side{std::fabs(a.x) + std::fabs(b.x) + std::fabs(c.x), std::fabs(a.y) + std::fabs(b.y) + std::fabs(c.y),
                    std::fabs(a.z) + std::fabs(b.z) + std::fabs(c.z)};
    return {centre - side, centre + side};
  }
};

}  // namespace straytrace::geometry
