// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cone.hpp"

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

template <>
std::span<Key<SerratedCone> const> keys_of<SerratedCone>() {
  using Shape = SerratedCone;
  static constexpr Key<Shape> keys[] = {
      {"inner_radius", &Shape::inner_radius, dim::length, required, 1e-6, 1e3, "of the tips of the teeth"},
      {"outer_radius", &Shape::outer_radius, dim::length, required, 1e-6, 1e3, "radius of the wide end"},
      {"half_angle", &Shape::half_angle, dim::angle, required, 1e-3, pi / 2 + 1e-12,
       "between axis and surface; 90 deg: flat"},
      {"tooth_depth", &Shape::tooth_depth, dim::length, required, 1e-9, 1e3, "from tip to valley, across the axis"},
      {"teeth", &Shape::teeth, dim::plain, required, 1, 100000, "number around the rim"},
      {"phase", &Shape::phase, dim::angle, 0, -2 * pi, 2 * pi, "azimuth of one tip"},
  };
  return keys;
}

ShapeComplaint impossible(SerratedCone const& s) {
  if (s.inner_radius + s.tooth_depth >= s.outer_radius)
    return {fmt::format("the valleys ({:g} m) reach beyond the wide end ({:g} m)", s.inner_radius + s.tooth_depth,
                        s.outer_radius),
            "make inner_radius + tooth_depth smaller than outer_radius"};
  if (s.teeth != std::floor(s.teeth)) return {fmt::format("{:g} teeth", s.teeth), "write a whole number"};
  if (s.half_angle > pi / 2 - 1e-3 && s.half_angle < pi / 2 - 1e-9)
    return {fmt::format("a half angle of {:.6f} deg is neither a cone nor flat", s.half_angle * 180 / pi),
            "write 90 deg for a flat ring, or less than 89.94 deg"};
  return {};
}

}  // namespace straytrace
