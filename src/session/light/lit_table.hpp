// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that beams illuminate, and surfaces that light must not reach.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "results/results.hpp"
#include "session/model.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// Surfaces illuminated by propagated beams, for `straytrace check`.

std::string lit_table(Model const&);            // empty when no beam has `lit`
nlohmann::ordered_json lit_json(Model const&);  // a list

// The tables that steer the walk, as stored in run files.

// The steering tables of this world.
ImportanceMap importance_map(World const&);
// Gives the world the strips, patches and adjoints of a run of the same scene: for display, not for tracing,
// since lists of targets are not stored. False: the map is of another scene.
bool show_importance(World&, ImportanceMap const&);

}  // namespace straytrace::session
