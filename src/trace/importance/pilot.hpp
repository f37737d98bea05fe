// SPDX-License-Identifier: BSD-3-Clause
// What paths scored after they arrived on each side of each patch, learned from a short run of its own
// (docs/theory/sampling.md): it knows mirrors and glass, which the diffuse exchange does not. Its histories never enter
// results.
#pragma once

#include <cstdint>
#include <vector>

#include "world/model/world.hpp"

namespace straytrace {

struct Pilot {
  std::vector<std::uint64_t> visits;        // by side
  std::vector<double> arrived;              // power, by side
  std::vector<std::vector<double>> scored;  // by goal (footprints, then receivers), then by side
};

// Histories are numbered from 2^63 up, so that production keeps its own numbers. The world has to be steered.
Pilot run_pilot(World const&, std::uint64_t histories);

}  // namespace straytrace
