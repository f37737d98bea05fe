// SPDX-License-Identifier: BSD-3-Clause
// The field of the cavity that the table `wave` of a scene names.
#pragma once

#include "session/options.hpp"
#include "wave/arm/arm_waves.hpp"

namespace straytrace::session {

// With progress on stderr. `highest_order` of the modes listed; -1: none.
ArmWaves solve_waves(World const&, unsigned threads, PrintOptions const&, int highest_order = -1);

}  // namespace straytrace::session
