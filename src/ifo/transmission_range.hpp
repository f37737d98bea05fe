// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace straytrace {

constexpr double least_transmission = 1e-12, most_transmission = 1 - 1e-9;  // of power, of a mirror that stands there

}  // namespace straytrace
