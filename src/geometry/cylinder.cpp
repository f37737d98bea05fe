// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cylinder.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Cylinder> const> keys_of<Cylinder>() {
  static constexpr Key<Cylinder> keys[] = {
      {"radius", &Cylinder::radius, dim::length, required, 1e-6, 1e3, "radius of the wall"},
      {"from", &Cylinder::from, dim::length, required, -1e6, 1e6, "start along the axis"},
      {"to", &Cylinder::to, dim::length, required, -1e6, 1e6, "end along the axis"},
  };
  return keys;
}

ShapeComplaint impossible(Cylinder const& s) {
  if (s.from >= s.to)
    return {fmt::format("the cylinder ends ({:g} m) before it starts ({:g} m)", s.to, s.from),
            "make 'from' smaller than 'to'"};
  return {};
}

}  // namespace straytrace
