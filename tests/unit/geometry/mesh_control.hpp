// SPDX-License-Identifier: BSD-3-Clause
// Shared by tests of meshes: random directions, poses, and the triangle test that leaks.
#pragma once

#include "support/mesh_shapes.hpp"

namespace straytrace::testing {

struct Random {
  Rng rng;
  explicit Random(std::uint64_t seed) : rng(seed, 0, 0, Stream::source) {}
  double uniform() { return rng.uniform(); }
  Vec3 direction() {
    double const z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z);
    SinCos const a = sincos_turn(rng.uniform());
    return {r * a.cos, r * a.sin, z};
  }
};

// Moeller and Trumbore 1997 with strict u, v > 0 and a smallest distance: the control.
inline double strict_distance(Vec3 o, Vec3 d, Vec3 a, Vec3 b, Vec3 c, double t_min) {
  Vec3 const e1 = b - a, e2 = c - a, p = cross(d, e2), s = o - a, q = cross(s, e1);
  double const det = dot(e1, p), u = dot(s, p) / det, v = dot(d, q) / det, t = dot(e2, q) / det;
  return u > 0 && v > 0 && u + v < 1 && t > t_min ? t : infinity;
}
inline Crossing strict_crossing(TriangleMesh const& m, Ray const& ray, double t_min) {
  Crossing best{infinity, no_piece};
  for (std::uint32_t i = 0; i < m.content.triangles.size; ++i) {
    double const t = strict_distance(m.pose.local_point(ray.origin), m.pose.local_direction(ray.dir), m.corner(i, 0),
                                     m.corner(i, 1), m.corner(i, 2), t_min);
    if (t < best.distance) best = {t, i};
  }
  return best;
}

inline std::vector<Pose> poses() {
  return {Pose{}, facing_along({0.3, -0.2, 3000}, {0, 0, -1}), facing_along({12, -7, 40000}, unit({1, 0.02, 1e-3}))};
}

}  // namespace straytrace::testing
