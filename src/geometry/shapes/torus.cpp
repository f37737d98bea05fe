// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/torus.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Torus> const> keys_of<Torus>() {
  static constexpr Key<Torus> keys[] = {
      {"major_radius", &Torus::major_radius, dim::length, required, 1e-6, 1e3,
       "from the axis to the middle of the tube"},
      {"minor_radius", &Torus::minor_radius, dim::length, required, 1e-7, 1e3, "of the tube"},
  };
  return keys;
}

ShapeComplaint impossible(Torus const& s) {
  if (s.minor_radius >= s.major_radius)
    return {fmt::format("the tube ({:g} m) is not thinner than the ring ({:g} m): the torus would cut itself",
                        s.minor_radius, s.major_radius),
            "make minor_radius smaller than major_radius"};
  if (s.minor_radius < 1e-4 * s.major_radius)
    return {fmt::format("the tube ({:g} m) is thinner than 1e-4 of the ring ({:g} m)", s.minor_radius, s.major_radius),
            "use a thin cylinder or a narrow ring; the roots would lose digits"};
  return {};
}

}  // namespace straytrace
