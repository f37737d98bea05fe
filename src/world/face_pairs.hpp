// SPDX-License-Identifier: BSD-3-Clause
// Pairs of surfaces that share space: faces that lie on each other, and faces that pass through each other. Found by
// points drawn on every surface, so that a contact smaller than about 1 % of both surfaces may stay unseen.
#pragma once

#include <vector>

#include "world/world.hpp"

namespace straytrace {

struct FacePair {
  SurfaceId first, second;  // first < second
  Vec3 at;                  // m, a place where it is seen
  double depth = 0;         // m, how far the surface that ends sooner reaches past the other; 0: they coincide
};

// Surfaces within a nanometre of each other, over an area, where light can come to: which of them it meets is decided
// by rounding or by their order in the scene. Left out are boundaries of two filled volumes (a cemented lens, which the
// walk passes as one boundary) and contacts that light cannot come to (inside closed bodies, or black on all sides).
std::vector<FacePair> coincident_faces(World const&);

// Surfaces of which each reaches past the other by more than `least_depth`, m. A surface that ends on another one
// (a baffle in its tube) is no crossing.
std::vector<FacePair> crossing_faces(World const&, double least_depth);

}  // namespace straytrace
