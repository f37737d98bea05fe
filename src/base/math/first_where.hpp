// SPDX-License-Identifier: BSD-3-Clause
// Binary search, for hosts and devices.
#pragma once

#include <cstdint>

#include "base/memory/host_device.hpp"

namespace straytrace {

// The first index from `low` to `end` - 1 for which `holds`, which is false up to it and true from it on; else `end`.
// `low` where that is not below `end`. The number of steps depends on that of the indices alone and no step branches:
// what is searched for is mostly random.
template <class Holds>
STRAY_HD std::uint32_t first_where(std::uint32_t low, std::uint32_t end, Holds const& holds) {
  for (std::uint32_t left = low < end ? end - low : 0; left > 0;) {
    std::uint32_t const half = (left + 1) / 2;
    low += holds(low + half - 1) ? 0 : half;
    left -= half;
  }
  return low;
}

}  // namespace straytrace
