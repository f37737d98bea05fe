// SPDX-License-Identifier: BSD-3-Clause
// Ghosts one by one: a beam of the tree from its last departure to where it ends.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "world/ghosts/main_beam.hpp"

namespace straytrace {

struct Ghost {
  std::uint64_t number = 0;  // in the order of the tree; the main beam counts as well
  BeamEnd end = BeamEnd::landed;
  std::uint32_t order = 0;
  GroupId where;           // landed, faint or longest: on this
  bool front = true;       // side of it
  Vec3 point, travel;      // m; where it ends, or leaves its last surface; direction there
  double power = 0;        // arriving there, over the launched power
  double clipped = 0;      // share of it beside the rim of what it lands on
  Spot spot;               // across the beam, m
  double path_length = 0;  // optical, from the launch, m
  GhostAlignment standing;
  std::span<BeamStep const> way;  // all surfaces before the end; valid during the call
};

// Grows the tree and passes on each beam that has ended; order 0 is the main beam.
BeamEnergyBalance find_ghosts(World const&, BeamLaunch const&, TreeLimits const&, MainBeam const&,
                              std::function<void(Ghost const&)> const& each);

}  // namespace straytrace
