// SPDX-License-Identifier: BSD-3-Clause
// Drawn paths that stand for all, in words.
#pragma once

#include <string>

#include "motion/motion.hpp"
#include "noise/strength_nodes.hpp"
#include "trace/coupling.hpp"

namespace straytrace {

struct DrawnError {
  double share = 0;  // standard error over the ASD of the total
  std::size_t bin = 0;
};

// How many paths were drawn, what that adds to the error of h, and why: the spot check that was off most, its route and
// the motion that moves its path most. Paths are the records of the table in its order; nodes.sampled() must hold.
std::string sharing_note(CouplingTable const&, MotionSet const&, PhaseSpectra const&, Strengths const&,
                         StrengthNodes const&, DrawnError const&);

}  // namespace straytrace
