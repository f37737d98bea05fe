// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cone.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Cone> const> keys_of<Cone>() {
  static constexpr Key<Cone> keys[] = {
      {"inner_radius", &Cone::inner_radius, dim::length, required, 0, 1e3,
       "radius of the rim, where the cone is placed"},
      {"outer_radius", &Cone::outer_radius, dim::length, required, 1e-6, 1e3, "radius of the wide end"},
      {"half_angle", &Cone::half_angle, dim::angle, required, 1e-3, pi / 2 - 1e-3, "between axis and generator"},
  };
  return keys;
}

ShapeComplaint impossible(Cone const& s) {
  if (s.inner_radius >= s.outer_radius)
    return {fmt::format("the rim ({:g} m) is not smaller than the wide end ({:g} m)", s.inner_radius, s.outer_radius),
            "make inner_radius smaller than outer_radius"};
  return {};
}

}  // namespace straytrace
