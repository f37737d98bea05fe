// SPDX-License-Identifier: BSD-3-Clause
// Vectors, rays and local frames. Lengths in metres.
#pragma once

#include <cmath>

#include "base/math/constants.hpp"
#include "base/memory/host_device.hpp"

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

// Mirror image of a direction at a plane with unit normal n.
STRAY_HD Vec3 reflected(Vec3 d, Vec3 n) { return d - (2 * dot(d, n)) * n; }

struct Ray {
  Vec3 origin, dir;         // m, unit vector
  double t_max = infinity;  // m; hits beyond it do not count
};

// Right-handed orthonormal frame with a given third axis (a proper rotation for -z too).
struct Frame {
  Vec3 e1, e2, e3;
  STRAY_HD static Frame around(Vec3 e3) {
    Vec3 const e1 = any_normal(e3);
    return {e1, cross(e3, e1), e3};
  }
  STRAY_HD Vec3 to_local(Vec3 v) const { return {dot(v, e1), dot(v, e2), dot(v, e3)}; }
  STRAY_HD Vec3 to_world(Vec3 v) const { return v.x * e1 + v.y * e2 + v.z * e3; }
};

// Position and orientation of a part in its parent frame: origin and axes in that frame (a proper rotation).
struct Pose {
  Vec3 origin, e1{1, 0, 0}, e2{0, 1, 0}, e3{0, 0, 1};
  STRAY_HD Vec3 direction(Vec3 v) const { return v.x * e1 + v.y * e2 + v.z * e3; }
  STRAY_HD Vec3 point(Vec3 p) const { return origin + direction(p); }
  STRAY_HD Vec3 local_direction(Vec3 v) const { return {dot(v, e1), dot(v, e2), dot(v, e3)}; }
  STRAY_HD Vec3 local_point(Vec3 p) const { return local_direction(p - origin); }
};
// Pose in the outermost frame of `inner`, which is given in the frame of `outer`.
STRAY_HD Pose nested(Pose const& outer, Pose const& inner) {
  return {outer.point(inner.origin), outer.direction(inner.e1), outer.direction(inner.e2), outer.direction(inner.e3)};
}
// Third axis given, the others arbitrary.
STRAY_HD Pose facing_along(Vec3 origin, Vec3 e3) {
  Frame const f = Frame::around(e3);
  return {origin, f.e1, f.e2, f.e3};
}

// Axis-parallel box, closed; initially empty.
struct Box {
  Vec3 lower{infinity, infinity, infinity}, upper{-infinity, -infinity, -infinity};
  STRAY_HD void add(Vec3 p) {
    lower = {p.x < lower.x ? p.x : lower.x, p.y < lower.y ? p.y : lower.y, p.z < lower.z ? p.z : lower.z};
    upper = {p.x > upper.x ? p.x : upper.x, p.y > upper.y ? p.y : upper.y, p.z > upper.z ? p.z : upper.z};
  }
  STRAY_HD void add(Box const& b) {
    lower = {b.lower.x < lower.x ? b.lower.x : lower.x, b.lower.y < lower.y ? b.lower.y : lower.y,
             b.lower.z < lower.z ? b.lower.z : lower.z};
    upper = {b.upper.x > upper.x ? b.upper.x : upper.x, b.upper.y > upper.y ? b.upper.y : upper.y,
             b.upper.z > upper.z ? b.upper.z : upper.z};
  }
};
// Box of everything between two heights along a unit axis through `origin` and within `radius` of that axis.
STRAY_HD Box box_about_axis(Vec3 origin, Vec3 axis, double low, double high, double radius) {
  Vec3 const side{radius * std::sqrt(std::fmax(0.0, 1 - axis.x * axis.x)),
                  radius * std::sqrt(std::fmax(0.0, 1 - axis.y * axis.y)),
                  radius * std::sqrt(std::fmax(0.0, 1 - axis.z * axis.z))};
  Box box;
  box.add(Box{origin + low * axis - side, origin + low * axis + side});
  box.add(Box{origin + high * axis - side, origin + high * axis + side});
  return box;
}

}  // namespace straytrace
