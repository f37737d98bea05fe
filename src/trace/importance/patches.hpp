// SPDX-License-Identifier: BSD-3-Clause
// Patches of scenes with more strips than the tables of importance can have rows.
#pragma once

#include "world/model/world.hpp"

namespace straytrace {

// Joins neighbours until there are at most `most` patches; a function of the scene only. Strips of one patch belong to
// one body and group and have one finish, and strips of lit surfaces and of receivers stay with their own surface, as
// far as `most` allows. Patches are small where beams and receivers are near and may be large where they are far.
void merge_strips(World const&, std::size_t most, SteeringTables&);

}  // namespace straytrace
