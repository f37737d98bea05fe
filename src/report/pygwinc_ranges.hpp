// SPDX-License-Identifier: BSD-3-Clause
// What the numbers of an ifo.yaml may be, by the end of their path.
#pragma once

#include <string>
#include <string_view>

namespace straytrace {

// Empty when the number may stand at this path ("Suspension.Stage.0.Mass"), otherwise what it must be.
std::string out_of_range(std::string_view path, double value);

}  // namespace straytrace
