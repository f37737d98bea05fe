// SPDX-License-Identifier: BSD-3-Clause
// Where a stated spot lies on a surface that its light would cross more than once: tubes, spheres, boxes.
#pragma once

#include "world/world.hpp"

namespace straytrace {

// Sets `backoff` of a footprint so that its lines start after the crossing before the one that is lit, and moves its
// centre along the chief ray to that one. Lit is the crossing at the centre, within the radius of the spot; otherwise
// the first, in the direction of travel, on a side that does more than absorb. Where the chief ray crosses once or not
// at all, nothing is changed.
void place_spot(World const&, Footprint&);

}  // namespace straytrace
