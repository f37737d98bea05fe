// SPDX-License-Identifier: BSD-3-Clause
#include "world/scattered_share.hpp"

#include "optics/specular.hpp"

namespace straytrace {

double scattered_share(World const& world, MaterialInfo const& info) {
  WorldView const view = world.view();
  return scatter_albedo(view.laws, view.optics[info.optic], 1.0);
}

}  // namespace straytrace
