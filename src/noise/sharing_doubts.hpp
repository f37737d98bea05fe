// SPDX-License-Identifier: BSD-3-Clause
// Spot checks of shared spectra in words.
#pragma once

#include <string>
#include <vector>

#include "motion/motion.hpp"
#include "noise/strength_nodes.hpp"
#include "trace/coupling.hpp"

namespace straytrace {

// One sentence per route with a path that is off by more than StrengthNodes::tolerance: route, size of the error,
// frequency and the motion that moves the path most. Paths are the records of the table in its order.
std::vector<std::string> sharing_doubts(CouplingTable const&, MotionSet const&, PhaseSpectra const&, Strengths const&,
                                        std::vector<SpotCheck> const&);

}  // namespace straytrace
