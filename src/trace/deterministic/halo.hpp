// SPDX-License-Identifier: BSD-3-Clause
// Light at angles below the crossover of the table `wave` that surfaces between the mirrors scatter straight back into
// the mode (docs/theory/wave.md, eq. W.19).
#pragma once

#include <string>
#include <vector>

#include "trace/coupling.hpp"
#include "wave/arm/arm_waves.hpp"

namespace straytrace::trace {

struct HaloClasses {
  std::vector<CouplingClass> classes;  // of kind `halo`: one for each mirror and each group that its light meets
  std::vector<std::string> warnings;
};
// Both mirrors that scatter below the crossover angle, and one below and one beyond it: 2 I_L^2 + 4 I_L I_H of eq.
// W.21. The part 2 I_H^2 is left to the walk. The factor 2 of speckle is C_rev, so that C_rev of the classes is 1.
HaloClasses halo_classes(World const&, ArmWaves const&);

}  // namespace straytrace::trace
