// SPDX-License-Identifier: BSD-3-Clause
// The tables that steer the walk, as stored in run files.
#pragma once

#include "results/results.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// The steering tables of this world.
ImportanceMap importance_map(World const&);
// Gives the world the strips, patches and adjoints of a run of the same scene: for display, not for tracing,
// since lists of targets are not stored. False: the map is of another scene.
bool show_importance(World&, ImportanceMap const&);

}  // namespace straytrace::session
