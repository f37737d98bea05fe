// SPDX-License-Identifier: BSD-3-Clause
// Which strips are worth aiming at from one side of a strip, and how often.
#pragma once

#include <vector>

#include "world/world.hpp"

namespace straytrace {

// transfer: share of the light that arrives on each side of each strip. adjoints: one per goal, by sides. The list is
// sorted by strip; its shares sum to 1.
std::vector<Target> targets_of(World const&, SteeringTables const&, std::vector<double> const& transfer,
                               std::vector<std::vector<double>> const& adjoints, std::size_t most);

}  // namespace straytrace
