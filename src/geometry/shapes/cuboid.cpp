// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cuboid.hpp"

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Cuboid> const> keys_of<Cuboid>() {
  static constexpr Key<Cuboid> keys[] = {
      {"width", &Cuboid::width, dim::length, required, 1e-6, 1e5, "full size along the x axis of the shape"},
      {"height", &Cuboid::height, dim::length, required, 1e-6, 1e5, "full size along its y axis"},
      {"depth", &Cuboid::depth, dim::length, required, 1e-6, 1e5, "full size along its axis, which is 'facing'"},
  };
  return keys;
}

ShapeComplaint impossible(Cuboid const&) { return {}; }

}  // namespace straytrace
