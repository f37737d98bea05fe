// SPDX-License-Identifier: BSD-3-Clause
// One triangle and one ray, without cracks: the sheared-ray test (Woop, Benthin, Wald, JCGT 2(1), 2013) in double.
// A ray becomes the z axis by a shear; a corner is sheared by the same operations in every triangle that has it, and
// the edge function of two corners changes exactly its sign with their order. Rounded products keep their order, so a
// computed edge function is never of the wrong sign, only zero too often; then its sign is computed exactly. Hence of
// two triangles at an edge at least one is hit by a ray through that edge, and a closed mesh has no leak.
#pragma once

#include <cstdint>

#include "base/math/vec3.hpp"

namespace straytrace::geometry {

struct MeshVertex {
  float x = 0, y = 0, z = 0;  // as in the file, in its unit
  bool operator==(MeshVertex const&) const = default;
};
struct MeshTriangle {
  std::uint32_t corner[3] = {};  // counter-clockwise seen from the front
};
STRAY_HD Vec3 exact(MeshVertex v) { return {v.x, v.y, v.z}; }

STRAY_HD double component(Vec3 const& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// The ray that becomes the z axis; lengths in the unit of the corners.
struct ShearedRay {
  int x = 0, y = 1, z = 2;                    // axes; z: the one along which the ray moves most
  double at[3] = {};                          // origin, in the order of these axes
  double slope_x = 0, slope_y = 0, step = 1;  // per unit of z; length along the ray per unit of z

  STRAY_HD ShearedRay(Vec3 origin, Vec3 dir) {
    double const ax = std::fabs(dir.x), ay = std::fabs(dir.y), az = std::fabs(dir.z);
    z = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    x = z == 2 ? 0 : z + 1;
    y = x == 2 ? 0 : x + 1;
    at[0] = component(origin, x);
    at[1] = component(origin, y);
    at[2] = component(origin, z);
    double const along = component(dir, z);
    slope_x = component(dir, x) / along;
    slope_y = component(dir, y) / along;
    step = 1 / along;
  }
  STRAY_HD Vec3 sheared(Vec3 corner) const {
    double const dz = component(corner, z) - at[2];
    return {(component(corner, x) - at[0]) - slope_x * dz, (component(corner, y) - at[1]) - slope_y * dz, dz};
  }
};

// Rounding error of a * b (Dekker 1971, splitting by Veltkamp): a * b = fl(a * b) + this, exactly.
STRAY_HD double product_error(double a, double b) {
  double const p = a * b, sa = 134217729 * a, sb = 134217729 * b;
  double const ah = sa - (sa - a), bh = sb - (sb - b), al = a - ah, bl = b - bh;
  return al * bl - (((p - ah * bh) - al * bh) - ah * bl);
}
// Twice the signed area of (axis of the ray, p, q): its sign gives the side of the edge on which the ray passes.
STRAY_HD double edge_function(Vec3 const& p, Vec3 const& q) { return p.x * q.y - p.y * q.x; }
STRAY_HD double exact_edge_function(Vec3 const& p, Vec3 const& q) {  // for fl(edge function) = 0
  return product_error(p.x, q.y) - product_error(p.y, q.x);
}

// Where the line of the ray meets the triangle, edges and corners included: length along the ray, negative behind the
// origin; infinity: nowhere. A triangle seen exactly edge-on is not met: its neighbours are.
STRAY_HD double line_meets(ShearedRay const& ray, Vec3 corner_a, Vec3 corner_b, Vec3 corner_c) {
  Vec3 const a = ray.sheared(corner_a), b = ray.sheared(corner_b), c = ray.sheared(corner_c);
  double u = edge_function(c, b), v = edge_function(a, c), w = edge_function(b, a);
  if (u == 0 || v == 0 || w == 0) {
    if (u == 0) u = exact_edge_function(c, b);
    if (v == 0) v = exact_edge_function(a, c);
    if (w == 0) w = exact_edge_function(b, a);
  }
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return infinity;
  double const sum = u + v + w;
  return sum != 0 ? (u * a.z + v * b.z + w * c.z) / sum * ray.step : infinity;
}

// Normal by the order of the corners, length twice the area; no zero vector for corners in one line (any direction
// across them), so that nothing downstream divides by zero.
STRAY_HD Vec3 facet_normal(Vec3 a, Vec3 b, Vec3 c) {
  Vec3 const n = cross(b - a, c - a);
  if (length2(n) > 0) return n;
  Vec3 const ab = b - a, ac = c - a, along = length2(ab) > length2(ac) ? ab : ac;
  return length2(along) > 0 ? any_normal(unit(along)) : Vec3{0, 0, 1};
}

// The point p moved into the plane and, where it is nearer than `margin` to an edge, that far inside (at most an
// eighth of a height): a path never starts on an edge, where the next ray could begin on the wrong side of a corner.
STRAY_HD Vec3 put_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c, double margin) {
  Vec3 const n = facet_normal(a, b, c);
  double const n2 = length2(n);
  Vec3 const q = p - (dot(n, p - a) / n2) * n;
  double share[3] = {dot(n, cross(c - b, q - b)) / n2, dot(n, cross(a - c, q - c)) / n2,
                     dot(n, cross(b - a, q - a)) / n2};
  // Height over an edge = n / edge.
  double const scale = margin / std::sqrt(n2);
  double const least[3] = {std::fmin(scale * length(c - b), 0.125), std::fmin(scale * length(a - c), 0.125),
                           std::fmin(scale * length(b - a), 0.125)};
  if (share[0] >= least[0] && share[1] >= least[1] && share[2] >= least[2]) return q;
  double room = 1, over = 0;
  for (int i = 0; i < 3; ++i) {
    share[i] = share[i] > least[i] ? share[i] - least[i] : 0;
    room -= least[i];
    over += share[i];
  }
  for (int i = 0; i < 3; ++i) share[i] = least[i] + (over > 0 ? share[i] / over : 1.0 / 3) * room;
  return share[0] * a + share[1] * b + share[2] * c;
}

// A ray leaves a triangle. A length near zero is pure rounding, so the positions of the triangles decide which
// hits close to the start are real:
//   1. the triangle itself is never hit;
//   2. one that reaches nowhere above the plane of the start, on the side the ray leaves to, is never hit: coplanar and
//      convex neighbours;
//   3. one that shares an edge and rises on that side is hit if and only if the ray moves towards its plane and its
//      line meets it, also where rounding puts the start behind it: concave corners.
// Everything else is hit at a positive length.
class LeavingRule {
 public:
  // Corners of the start, its vertex numbers, direction of the ray.
  STRAY_HD LeavingRule(Vec3 a, Vec3 b, Vec3 c, MeshTriangle const& numbers, Vec3 dir) : start_{a, b, c}, dir_(dir) {
    for (int i = 0; i < 3; ++i) number_[i] = numbers.corner[i];
    up_ = facet_normal(a, b, c);
    if (dot(up_, dir) < 0) up_ = -up_;
    double const ab = length(b - a), ac = length(c - a);
    near_ = reach(ab, ac);
    rounding_ = 0x1p-50 * ab * ac;
  }
  // Where the rule ends, for two edges of the start.
  STRAY_HD static double reach(double ab, double ac) { return 0x1p-10 * (ab + ac); }
  STRAY_HD bool asks(double t) const { return std::fabs(t) < near_; }
  // The length at which another triangle is hit whose line meets it at t; infinity: not hit.
  STRAY_HD double judged(double t, Vec3 const (&other)[3], MeshTriangle const& numbers) const {
    int shared = 0, spare = 3;  // spare: sum of the places of the shared corners taken from 0 + 1 + 2
    bool above = false;
    Vec3 common;
    for (int i = 0; i < 3; ++i) {
      int same = -1;
      for (int k = 0; k < 3; ++k)
        if (numbers.corner[i] == number_[k]) same = k;
      if (same >= 0) {
        ++shared;
        spare -= same;
        common = other[i];
      } else if (rises(other[i])) {
        above = true;
      }
    }
    if (!above) return infinity;
    if (shared != 2) return t > 0 ? t : infinity;
    Vec3 const n = facet_normal(other[0], other[1], other[2]);
    if (!(dot(n, start_[spare] - common) * dot(n, dir_) < 0)) return infinity;
    return t > 0 ? t : 0x1p-1000;
  }

 private:
  STRAY_HD bool rises(Vec3 p) const {
    Vec3 const w = p - start_[0];
    return dot(up_, w) > rounding_ * length(w);
  }
  Vec3 start_[3], dir_, up_;
  std::uint32_t number_[3] = {};
  double near_ = 0, rounding_ = 0;  // rounding_: of a height over the plane, times twice the area, per distance
};

}  // namespace straytrace::geometry
