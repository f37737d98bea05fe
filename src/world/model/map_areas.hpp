// SPDX-License-Identifier: BSD-3-Clause
// Areas of surfaces, and of the cells of maps within the rim of their surface.
#pragma once

#include <vector>

#include "base/memory/ids.hpp"
#include "world/model/receiver.hpp"
#include "world/model/view.hpp"

namespace straytrace::world {

// As filled_share(), of a map that stands in `frame`.
double filled_share(WorldView const&, SurfaceId, Chart, MapCell const&, Pose const& frame);

// Of each pixel or cell of a receiver's map on this surface, m^2: what lies beyond the rim does not count. A cell that
// the rim leaves nothing of has its whole area.
std::vector<double> map_areas(WorldView const&, SurfaceId, Receiver const&);

// Of all surfaces of each group, m^2; a surface has one side.
std::vector<double> group_areas(WorldView const&, std::size_t groups);

}  // namespace straytrace::world
