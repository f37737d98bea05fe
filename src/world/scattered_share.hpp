// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "world/world.hpp"

namespace straytrace {

// Share of the light at normal incidence that a material scatters, to both sides together.
double scattered_share(World const&, MaterialInfo const&);

}  // namespace straytrace
