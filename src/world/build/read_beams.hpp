// SPDX-License-Identifier: BSD-3-Clause
// The pieces of read_beams: each reads one kind of beam, or the ports.
#pragma once

#include <string>
#include <vector>

#include "world/build/read_parts.hpp"
#include "world/model/world.hpp"

namespace straytrace {

// What a beam hands to all its footprints.
struct Lighting {
  std::string name;
  std::uint32_t number = 0;
  double power = 1;  // over that of the first beam that states one (q of eq. 1.1)
};

void read_cavity(Node const& beam, Node const& cavity, Registry const&, World&, Lighting const&);
void read_free(Node const& beam, Registry const&, World&, Lighting const&);  // key `from`
void read_spot(Node const& beam, Registry const&, World&, Lighting const&);  // key `on`

// Beams as far as they were read; `broken` ones have a problem of their own, which ports need not repeat.
struct Beams {
  std::vector<std::string> names;
  std::vector<bool> broken;
};
void read_ports(Scene const&, World&, Registry const&, Beams const&);

// The key `lit` of a beam: whether it is followed through the scene, and what of it counts.
struct LitWish {
  bool wanted = false;
  double floor = 1e-9;                    // weakest beam followed, over the one launched
  std::uint32_t order = 0;                // of ghosts
  std::vector<std::string> only, except;  // patterns of names; `only` empty: all
};
LitWish read_lit(Node const& beam, Registry const&);
// Lights every surface that the beam meets, from the footprints it has so far. Nothing happens while the document has
// problems.
void light_up(Node const& beam, LitWish const&, Registry const&, World&, Lighting const&);

// Where a stated spot lies on a surface that its light would cross more than once: tubes, spheres, boxes.

// Sets `backoff` of a footprint so that its lines start after the crossing before the one that is lit, and moves its
// centre along the chief ray to that one. Lit is the crossing at the centre, within the radius of the spot; otherwise
// the first, in the direction of travel, on a side that does more than absorb. Where the chief ray crosses once or not
// at all, nothing is changed.
void place_spot(World const&, Footprint&);

}  // namespace straytrace
