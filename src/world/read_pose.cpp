// SPDX-License-Identifier: BSD-3-Clause
// Where a part stands: the keys at, facing and rotate.
#include <cmath>

#include "world/read_parts.hpp"

namespace straytrace {

namespace {

// Turns by `angle` about the unit vector `axis` (Rodrigues).
Vec3 turned(Vec3 v, Vec3 axis, double cosine, double sine) {
  return cosine * v + sine * cross(axis, v) + ((1 - cosine) * dot(axis, v)) * axis;
}

Pose rotated(Vec3 origin, Vec3 axis, double cosine, double sine) {
  return {origin, turned({1, 0, 0}, axis, cosine, sine), turned({0, 1, 0}, axis, cosine, sine),
          turned({0, 0, 1}, axis, cosine, sine)};
}

// The smallest turn that takes z to `to`; half a turn about x for -z (requirements.md R3.21).
Pose facing(Vec3 origin, Vec3 to) {
  Vec3 const across = cross({0, 0, 1}, to);
  double const sine = length(across);
  if (sine == 0) return {origin, {1, 0, 0}, {0, std::copysign(1.0, to.z), 0}, {0, 0, std::copysign(1.0, to.z)}};
  return rotated(origin, (1 / sine) * across, to.z, sine);
}

}  // namespace

Pose read_pose(Node const& table) {
  Pose pose;
  if (Node const at = table["at"]) pose.origin = read_vector(at, dim::length);
  Node const face = table["facing"], rotate = table["rotate"];
  if (face && rotate) table.problem("'facing' and 'rotate' both turn the part", "keep one of them");
  if (face)
    if (auto const to = read_direction(face)) return facing(pose.origin, *to);
  if (rotate) {
    if (!rotate.has("axis")) rotate.problem("'axis' is missing", "write {axis: [1, 0, 0], angle: 30 deg}");
    auto const axis = read_direction(rotate["axis"]);
    double const angle = rotate.number("angle", dim::angle, required, -2 * pi, 2 * pi);
    rotate.refuse_unknown("'rotate'");
    if (axis) return rotated(pose.origin, *axis, std::cos(angle), std::sin(angle));
  }
  return pose;
}

}  // namespace straytrace
