// SPDX-License-Identifier: BSD-3-Clause
// What happens to light at a surface, as routes tell it.
#pragma once

#include <cstdint>

namespace straytrace {

enum class Event : std::uint8_t { emit, scatter, reflect, couple, transmit, receive, start, diffract };

}  // namespace straytrace
