// SPDX-License-Identifier: BSD-3-Clause
// Chief rays of a beam when the bodies on its way move: first order, by rigid motion (docs/theory/ghosts.md, eq. N.27).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "world/ghosts/beam_tree.hpp"

namespace straytrace::world {

// Per metre or radian of a coordinate: of the point where the ray crosses a plane across it, and of its direction. Both
// lie across the ray.
struct RayShift {
  Vec3 shift, turn;  // m, rad
};

struct MovedRay {
  BodyId body;
  std::array<RayShift, 6> by{};  // coordinates as in PhaseSensitivity::d
};

// Of the ray that leaves the last surface of a way, at a point of it. Snell's law on the moved, turned and curved
// surface, n_in a - n_out b along its normal; elastic modes do not move the ray. Nothing without a way.
std::vector<MovedRay> moved_rays(World const&, std::span<BeamStep const> way, Vec3 at);

}  // namespace straytrace::world
