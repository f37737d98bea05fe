// SPDX-License-Identifier: BSD-3-Clause
// Paths of computed routes as lines: ghosts by the beam tree, and diffraction at edges.
#pragma once

#include <vector>

#include "report/ray_paths.hpp"
#include "results/ghosts/ghost_table.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// Of one such route, at most so many: by points of its rims, evenly over rims and azimuths, or of the ghosts in the
// rows that go this way; none when no row does.
std::vector<DrawnPath> computed_paths(World const&, CouplingClass const&, std::vector<GhostReport> const&,
                                      std::size_t most);

}  // namespace straytrace::session
