// SPDX-License-Identifier: BSD-3-Clause
// One way to ask simple shapes and shapes made of many flat pieces (meshes): where a ray meets them, and what is there.
#pragma once

#include <cstdint>

#include "base/math/vec3.hpp"

namespace straytrace {

constexpr std::uint32_t no_piece = 0xffffffffu;

// Distance to a surface along a ray, m, and the piece of it that is hit (0 for a shape without pieces).
struct Crossing {
  double distance = infinity;
  std::uint32_t piece = 0;
};

// A point drawn on a surface, uniform in area.
struct SurfacePoint {
  Vec3 point;
  std::uint32_t piece = 0;
};

// A shape with pieces says `static constexpr bool has_pieces = true` and offers
//   Crossing crossing(Ray const&, std::uint32_t leaving) const   leaving: the piece the ray starts on, or no_piece
//   Vec3 normal(Vec3 p, std::uint32_t piece) const, Vec3 project(Vec3 p, std::uint32_t piece) const
//   SurfacePoint sample(double u, double v) const
// in place of distance, normal, project and sample of simple shapes (shape_types.hpp).
template <class S>
concept HasPieces = requires {
  requires S::has_pieces;
};

// Whether a straight line between two points of the shape may cross it in between: other than for the quadrics, whose
// lines meet them twice.
template <class S>
inline constexpr bool may_hide_itself = HasPieces<S>;

template <class S>
STRAY_HD Crossing crossing_of(S const& s, Ray const& ray, bool leaving, std::uint32_t piece) {
  if constexpr (HasPieces<S>)
    return s.crossing(ray, leaving ? piece : no_piece);
  else
    return {s.distance(ray, leaving), 0};
}
template <class S>
STRAY_HD Vec3 normal_of(S const& s, Vec3 p, std::uint32_t piece) {
  if constexpr (HasPieces<S>)
    return s.normal(p, piece);
  else
    return s.normal(p);
}
template <class S>
STRAY_HD Vec3 projected_on(S const& s, Vec3 p, std::uint32_t piece) {
  if constexpr (HasPieces<S>)
    return s.project(p, piece);
  else
    return s.project(p);
}
template <class S>
STRAY_HD SurfacePoint sample_of(S const& s, double u, double v) {
  if constexpr (HasPieces<S>)
    return s.sample(u, v);
  else
    return {s.sample(u, v), 0};
}

}  // namespace straytrace
