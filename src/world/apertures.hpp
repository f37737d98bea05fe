// SPDX-License-Identifier: BSD-3-Clause
// What the beams of a scene pass through: rims around their axes, and the rims of the mirrors that they light.
#pragma once

#include <vector>

#include "beams/diffraction.hpp"
#include "world/world.hpp"

namespace straytrace {

struct BeamAperture {
  std::uint32_t beam = 0;
  GroupId group;
  SurfaceId surface;
  bool reflected = false;  // the rim of a mirror: what goes on is reflected
  double along = 0;        // m, from where the beam starts; of a cavity, from its first mirror
  BeamInPlane at;          // as it leaves the plane of the rim
  Opening opening;         // x runs from the axis of the beam to its centre
};

// Modes of cavities between their mirrors, free beams up to the first surface, and spots on disks and caps. Gaussian
// beams only. In the order of the beams, along each.
std::vector<BeamAperture> apertures_of(World const&);

}  // namespace straytrace
