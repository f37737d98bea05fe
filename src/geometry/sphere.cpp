// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/sphere.hpp"

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Sphere> const> keys_of<Sphere>() {
  static constexpr Key<Sphere> keys[] = {
      {"radius", &Sphere::radius, dim::length, required, 1e-6, 1e6, "radius"},
  };
  return keys;
}

ShapeComplaint impossible(Sphere const&) { return {}; }

}  // namespace straytrace
