// SPDX-License-Identifier: BSD-3-Clause
// Bodies that hang: `suspended: {from: ground, vertical: y, stages: [...], vertical_stages: [...]}`.
#pragma once

#include <array>

#include "motion/axis_motion.hpp"

namespace straytrace {

// Adds to the coordinates of a body what comes down its suspension: the two horizontal ones through `stages`, the one
// named by `vertical` through `vertical_stages` if there are any; rotations of the support are not passed on. Returns
// which coordinates are stated by it.
std::array<bool, 6> add_suspended(Node const& suspended, std::array<AxisMotion, 6>& axes);

}  // namespace straytrace
