// SPDX-License-Identifier: BSD-3-Clause
// How well it is known where a line meets a surface: docs/theory/sampling.md, eq. 1.14.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math/vec3.hpp"

namespace straytrace {

// The largest length from which hits on the shape are computed, m: a coordinate in the world of its points or of the
// point its equations are written about, or what the shape itself says (`largest_length`).
template <class Shape>
double scale_of(Shape const& s) {
  Box box = s.bounds();
  box.add(s.reference());
  Vec3 const &a = box.lower, &b = box.upper;
  double const scale = std::max({-a.x, -a.y, -a.z, b.x, b.y, b.z});
  if constexpr (requires { s.largest_length(); }) return std::max(scale, s.largest_length());
  return scale;
}

// A line to a point drawn on a surface, `way` m away, meets the surface at most this much before the point, m
// (eq. 1.14). `scale`: of the surface, m; `cosine`: between the line and the normal where they meet, not negative.
STRAY_HD double hit_slack(double scale, double way, double cosine) {
  return std::fmin(0x1p-46 * (scale + way) / cosine, way);
}

}  // namespace straytrace
