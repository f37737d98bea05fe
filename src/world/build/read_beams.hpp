// SPDX-License-Identifier: BSD-3-Clause
// The pieces of read_beams: each reads one kind of beam, or the ports.
#pragma once

#include <string>
#include <vector>

#include "world/build/read_parts.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// Common properties of all footprints of a beam.
struct Lighting {
  std::string name;
  std::uint32_t number = 0;
  double power = 1;  // over that of the first beam that states one (q of eq. 1.1)
};

void read_cavity(Node const& beam, Node const& cavity, Registry const&, World&, Lighting const&);
void read_free(Node const& beam, Registry const&, World&, Lighting const&);  // key `from`
void read_spot(Node const& beam, Registry const&, World&, Lighting const&);  // key `on`

// The beams read so far; for `broken` ones a problem is already reported.
struct Beams {
  std::vector<std::string> names;
  std::vector<bool> broken;
};
void read_ports(Scene const&, World&, Registry const&, Beams const&);

// The key `lit` of a beam: whether it propagates through the scene, and which of its spots count.
struct LitWish {
  bool wanted = false;
  double floor = 1e-9;                    // weakest beam followed, over the one launched
  std::uint32_t order = 0;                // of ghosts
  std::vector<std::string> only, except;  // patterns of names; `only` empty: all
};
LitWish read_lit(Node const& beam, Registry const&);
// Adds footprints on every surface that the beam meets, starting from its footprints so far. Does nothing while the
// document has problems.
void light_up(Node const& beam, LitWish const&, Registry const&, World&, Lighting const&);

// Places a stated spot on a surface that its light crosses more than once: tubes, spheres, boxes. Sets `backoff` of the
// footprint so that its lines start after the crossing before the illuminated one, and moves its centre along the chief
// ray to that one. The illuminated crossing is the one within the radius of the spot about its centre; otherwise the
// first, in the direction of travel, on a side that does not only absorb. Changes nothing if the chief ray crosses at
// most once.
void place_spot(World const&, Footprint&);

}  // namespace straytrace::world
