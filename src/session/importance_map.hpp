// SPDX-License-Identifier: BSD-3-Clause
// The tables that steer the walk, as run files keep them.
#pragma once

#include "results/results.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// What this world is steered by.
ImportanceMap importance_map(World const&);
// Gives the world the strips, patches and adjoints of a run of the same scene: to be looked at, not to trace with,
// since lists of targets are not kept. False: the map is of another scene.
bool show_importance(World&, ImportanceMap const&);

}  // namespace straytrace::session
