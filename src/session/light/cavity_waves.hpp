// SPDX-License-Identifier: BSD-3-Clause
// The field of the cavity that the table `wave` of a scene names.
#pragma once

#include "session/options.hpp"
#include "wave/arm/arm_waves.hpp"

namespace straytrace::session {

// With progress on stderr.
ArmWaves solve_waves(World const&, unsigned threads, PrintOptions const&, ArmOptions = {});

}  // namespace straytrace::session
