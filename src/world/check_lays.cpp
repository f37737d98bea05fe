// SPDX-License-Identifier: BSD-3-Clause
// Grooves without a direction: their lay is the normal of a flat surface.
#include <fmt/format.h>

#include <type_traits>

#include "world/read_parts.hpp"

namespace straytrace {
namespace {

// Whether the direction of the grooves is the normal of a flat surface: then they run anyhow.
bool lay_vanishes(WorldView const& view, Surface const& s, Optic const& o) {
  if (o.lay != Lay::along && o.lay != Lay::given) return false;
  return view.shapes.visit(s.shape, [&](auto const& shape) {
    using Shape = std::decay_t<decltype(shape)>;
    if constexpr (std::is_same_v<Shape, Disk> || std::is_base_of_v<PlaneFrame, Shape>)
      return o.lay == Lay::along || length(cross(o.lay_direction, shape.axis)) < 1e-9;
    else
      return false;
  });
}

}  // namespace

void check_lays(Scene const& scene, World const& world) {
  WorldView const view = world.view();
  for (Surface const& s : world.surfaces())
    if (lay_vanishes(view, s, view.optics[s.front]) || lay_vanishes(view, s, view.optics[s.back]))
      scene.root()["scene"].warning(
          fmt::format("the grooves of '{}' run along its normal: on the surface they have no direction",
                      world.groups()[s.group.value]),
          "write lay: around, or a direction that lies in the surface");
}

}  // namespace straytrace
