// SPDX-License-Identifier: BSD-3-Clause
// The field of the cavity that the table `wave` of a scene names.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "session/model.hpp"
#include "session/options.hpp"
#include "wave/arm/arm_waves.hpp"

namespace straytrace::session {

// The plan of its field, with problems at the keys that cause them; none without the table or in a scene with errors.
std::optional<ArmCavity> plan_waves(Scene const&, World const&);
// Crossover angle, grid and memory, for `straytrace check`; empty without a plan.
std::string wave_line(Model const&);
nlohmann::ordered_json wave_json(Model const&);  // null without a plan
// With progress on stderr.
ArmWaves solve_waves(Model const&, unsigned threads, PrintOptions const&, ArmOptions = {});

}  // namespace straytrace::session
