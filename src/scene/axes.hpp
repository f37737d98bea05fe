// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string_view>

namespace straytrace {

// Along which parts are repeated.
constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

}  // namespace straytrace
