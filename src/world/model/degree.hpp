// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/math/constants.hpp"

namespace straytrace {

constexpr double degree = pi / 180;  // rad

}  // namespace straytrace
