// SPDX-License-Identifier: BSD-3-Clause
#include "noise/speckle.hpp"

#include <cmath>

namespace straytrace {

double speckle_percentile(double below) { return -std::log1p(-below); }

}  // namespace straytrace
