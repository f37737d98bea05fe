// SPDX-License-Identifier: BSD-3-Clause
// Sums of a trace -> coupling table with routes named and records replayed.
#pragma once

#include "trace/result.hpp"
#include "world/model/world.hpp"

namespace straytrace {

CouplingTable make_coupling_table(World const&, BlockSums const& total, std::uint64_t seed);

}  // namespace straytrace
