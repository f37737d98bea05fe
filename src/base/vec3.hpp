// SPDX-License-Identifier: BSD-3-Clause
// Vectors, rays and local frames. Lengths in metres.
#pragma once

#include <cmath>

#include "base/constants.hpp"
#include "base/host_device.hpp"

namespace straytrace {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};
STRAY_HD Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
STRAY_HD Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
STRAY_HD Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
STRAY_HD Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
STRAY_HD double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
STRAY_HD Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
STRAY_HD double length2(Vec3 a) { return dot(a, a); }
STRAY_HD double length(Vec3 a) { return std::sqrt(dot(a, a)); }
STRAY_HD Vec3 unit(Vec3 a) { return (1 / std::sqrt(dot(a, a))) * a; }

// A unit vector at right angles to the unit vector a.
STRAY_HD Vec3 any_normal(Vec3 a) { return unit(std::fabs(a.x) < 0.5 ? Vec3{0, -a.z, a.y} : Vec3{-a.y, a.x, 0}); }

// Mirror image of a direction at a plane with unit normal n (requirements.md R3.22).
STRAY_HD Vec3 reflected(Vec3 d, Vec3 n) { return d - (2 * dot(d, n)) * n; }

struct Ray {
  Vec3 origin, dir;         // m, unit vector
  double t_max = infinity;  // m; hits beyond it do not count
};

// Right-handed orthonormal frame whose third axis is given (proper rotation also for -z: requirements.md R3.21).
struct Frame {
  Vec3 e1, e2, e3;
  STRAY_HD static Frame around(Vec3 e3) {
    Vec3 const e1 = any_normal(e3);
    return {e1, cross(e3, e1), e3};
  }
  STRAY_HD Vec3 to_local(Vec3 v) const { return {dot(v, e1), dot(v, e2), dot(v, e3)}; }
  STRAY_HD Vec3 to_world(Vec3 v) const { return v.x * e1 + v.y * e2 + v.z * e3; }
};

}  // namespace straytrace
