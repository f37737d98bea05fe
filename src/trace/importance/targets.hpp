// SPDX-License-Identifier: BSD-3-Clause
// Which patches are worth aiming at from one side of a patch, and how often.
#pragma once

#include <vector>

#include "trace/importance/law_share.hpp"

namespace straytrace {

// Parts of the scene: groups of bodies, numbered.
struct Parts {
  std::vector<std::uint32_t> of_patch, body;  // part of each patch, body of each part
};
Parts parts_of(World const&, SteeringTables const&);

// transfer: share of the light that arrives on each side of each patch. The list is sorted by patch; its shares sum
// to 1.
std::vector<Target> targets_of(Parts const&, std::vector<float> const& transfer, std::vector<Worth> const& worths,
                               std::size_t most);

}  // namespace straytrace
