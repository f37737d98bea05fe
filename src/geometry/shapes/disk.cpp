// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/disk.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Disk> const> keys_of<Disk>() {
  static constexpr Key<Disk> keys[] = {
      {"outer_radius", &Disk::outer_radius, dim::length, required, 1e-6, 1e3, "radius of the rim"},
      {"inner_radius", &Disk::inner_radius, dim::length, 0, 0, 1e3, "radius of the central hole"},
  };
  return keys;
}

ShapeComplaint impossible(Disk const& s) {
  if (s.inner_radius >= s.outer_radius)
    return {fmt::format("the hole ({:g} m) is not smaller than the disk ({:g} m)", s.inner_radius, s.outer_radius),
            "make inner_radius smaller than outer_radius"};
  return {};
}

template <>
std::span<Key<Ellipse> const> keys_of<Ellipse>() {
  static constexpr Key<Ellipse> keys[] = {
      {"semi_x", &Ellipse::semi_x, dim::length, required, 1e-6, 1e3, "semi-axis along the x axis of the shape"},
      {"semi_y", &Ellipse::semi_y, dim::length, required, 1e-6, 1e3, "semi-axis along its y axis"},
      {"hole_x", &Ellipse::hole_x, dim::length, 0, 0, 1e3, "semi-axis of the central hole along x"},
      {"hole_y", &Ellipse::hole_y, dim::length, 0, 0, 1e3, "semi-axis of the central hole along y"},
  };
  return keys;
}

ShapeComplaint impossible(Ellipse const& s) {
  if ((s.hole_x > 0) != (s.hole_y > 0)) return {"the hole has only one of 'hole_x' and 'hole_y'", "give both, or none"};
  if (s.hole_x > s.semi_x || s.hole_y > s.semi_y || s.hole_x * s.hole_y >= s.semi_x * s.semi_y)
    return {fmt::format("the hole (semi-axes {:g} m, {:g} m) does not fit into the ellipse ({:g} m, {:g} m)", s.hole_x,
                        s.hole_y, s.semi_x, s.semi_y),
            "make the hole smaller; these are semi-axes, half of the full sizes"};
  return {};
}

}  // namespace straytrace
