// SPDX-License-Identifier: BSD-3-Clause
// Routes of the mirrors and of the rims that the table `wave` names, from the solved field of their cavity
// (docs/theory/wave.md, eq. W.14, W.22, W.26, W.27).
#pragma once

#include <vector>

#include "trace/coupling.hpp"
#include "wave/arm/arm_waves.hpp"

namespace straytrace::trace {

// For each group of rims one class of kind `wave`, and one of kind `speckle` for those whose light the grid does not
// hold; and one of kind `wave` for the outlines and heights of both mirrors. No record changes when all bodies move
// together. Powers of rims add; both directions of the light are in each, so that C_rev is 1. The port is that of the
// first mirror, or of the second where that has none.
std::vector<CouplingClass> wave_rim_classes(World const&, ArmWaves const&);

}  // namespace straytrace::trace
