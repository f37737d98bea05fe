// SPDX-License-Identifier: BSD-3-Clause
// Routes of the rims that the table `wave` names, from the solved field of their cavity (docs/theory/wave.md, eq. W.14
// and W.22).
#pragma once

#include <vector>

#include "trace/coupling.hpp"
#include "wave/arm/arm_waves.hpp"

namespace straytrace::trace {

// For each group of rims one class of kind `wave`, and one of kind `speckle` for those whose light the grid does not
// hold. Powers of rims add; both directions of the light are in each, so that C_rev is 1. The port is that of the first
// mirror, or of the second where that has none.
std::vector<CouplingClass> wave_rim_classes(World const&, ArmWaves const&);

}  // namespace straytrace::trace
