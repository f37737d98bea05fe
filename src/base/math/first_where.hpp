// SPDX-License-Identifier: BSD-3-Clause
// Binary search, for hosts and devices.
#pragma once

#include <cstdint>

#include "base/memory/host_device.hpp"

namespace straytrace {

// The first index from `low` to `end` - 1 for which `holds`, which is false up to it and true from it on; else `end`.
// `low` where that is not below `end`.
template <class Holds>
STRAY_HD std::uint32_t first_where(std::uint32_t low, std::uint32_t end, Holds const& holds) {
  while (low < end) {
    std::uint32_t const mid = low + (end - low) / 2;
    if (holds(mid))
      end = mid;
    else
      low = mid + 1;
  }
  return low;
}

}  // namespace straytrace
