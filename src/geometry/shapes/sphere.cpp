// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/sphere.hpp"

#include <fmt/format.h>

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

template <>
std::span<Key<Zone> const> keys_of<Zone>() {
  static constexpr Key<Zone> keys[] = {
      {"radius", &Zone::radius, dim::length, required, 1e-6, 1e6, "radius of the sphere"},
      {"from", &Zone::from, dim::length, required, -1e6, 1e6, "lower end, from the centre along the axis"},
      {"to", &Zone::to, dim::length, required, -1e6, 1e6, "upper end, from the centre along the axis"},
  };
  return keys;
}

ShapeComplaint impossible(Zone const& s) {
  if (s.from >= s.to)
    return {fmt::format("the zone ends ({:g} m) before it starts ({:g} m)", s.to, s.from),
            "make 'from' smaller than 'to'"};
  if (s.from < -s.radius || s.to > s.radius)
    return {fmt::format("the zone from {:g} m to {:g} m reaches beyond the sphere of radius {:g} m", s.from, s.to,
                        s.radius),
            "heights are measured from the centre of the sphere"};
  return {};
}

}  // namespace straytrace
