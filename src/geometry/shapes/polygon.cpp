// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/polygon.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Polygon> const> keys_of<Polygon>() {
  static constexpr Key<Polygon> keys[] = {
      {"sides", &Polygon::sides, dim::plain, required, 0, 1000, "number of sides; 0: a circle"},
      {"radius", &Polygon::radius, dim::length, required, 1e-6, 1e3, "from the centre to the corners"},
      {"rotation", &Polygon::rotation, dim::angle, 0, -2 * pi, 2 * pi, "azimuth of the first corner"},
      {"hole_sides", &Polygon::hole_sides, dim::plain, 0, 0, 1000, "number of sides of the hole; 0: a circle"},
      {"hole_radius", &Polygon::hole_radius, dim::length, 0, 0, 1e3, "to the corners of the hole; 0: no hole"},
      {"hole_rotation", &Polygon::hole_rotation, dim::angle, 0, -2 * pi, 2 * pi, "azimuth of its first corner"},
  };
  return keys;
}

namespace {

// Outlines are convex: one lies within the other when its corners do, a circle when the sides keep clear of it.
bool fits(RegularOutline const& hole, RegularOutline const& plate) {
  if (plate.sides == 0) return hole.radius < plate.radius;
  if (hole.sides == 0) return hole.radius < plate.apothem;
  for (double k = 0; k < hole.sides; ++k) {
    SinCos const a = sincos_turn(k / hole.sides + hole.rotation / (2 * pi));
    if (!plate.contains(hole.radius * a.cos, hole.radius * a.sin)) return false;
  }
  return hole.area() < plate.area();
}

}  // namespace

ShapeComplaint impossible(Polygon const& given) {
  for (double sides : {given.sides, given.hole_sides})
    if (sides != std::floor(sides) || (sides > 0 && sides < 3))
      return {fmt::format("a polygon cannot have {:g} sides", sides),
              "write a whole number from 3 on, or 0 for a circle"};
  Polygon s = given;
  s.place({});
  if (s.hole_radius > 0 && !fits(s.hole(), s.outline()))
    return {fmt::format("the hole ({:g} m) does not fit into the polygon ({:g} m)", s.hole_radius, s.radius),
            "make hole_radius smaller; both radii reach to the corners"};
  return {};
}

}  // namespace straytrace
