// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/every_module.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {

// One optic for every BSDF model, with a small additional reflectance.
std::vector<std::uint32_t> optics_of_all_laws(World&);

}  // namespace straytrace::testing
