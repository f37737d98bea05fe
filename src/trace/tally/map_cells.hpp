// SPDX-License-Identifier: BSD-3-Clause
// Cells of maps without stated pixels, as small as the light of a short run of its own allows. Its histories never
// enter results, so what falls into the cells does not know how they were made. A function of the scene only.
#pragma once

#include "world/model/world.hpp"

namespace straytrace {

// Of a world that is steered, where a receiver asks for it.
void find_map_cells(World&);

}  // namespace straytrace
