// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/rectangle.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Rectangle> const> keys_of<Rectangle>() {
  static constexpr Key<Rectangle> keys[] = {
      {"width", &Rectangle::width, dim::length, required, 1e-6, 1e5, "full size along the x axis of the shape"},
      {"height", &Rectangle::height, dim::length, required, 1e-6, 1e5, "full size along its y axis"},
      {"hole_width", &Rectangle::hole_width, dim::length, 0, 0, 1e5, "full width of the central hole"},
      {"hole_height", &Rectangle::hole_height, dim::length, 0, 0, 1e5, "full height of the central hole"},
  };
  return keys;
}

ShapeComplaint impossible(Rectangle const& s) {
  if ((s.hole_width > 0) != (s.hole_height > 0))
    return {"the hole has only one of 'hole_width' and 'hole_height'", "give both, or none"};
  if (s.hole_width > s.width || s.hole_height > s.height || s.hole_width * s.hole_height >= s.width * s.height)
    return {fmt::format("the hole ({:g} m x {:g} m) does not fit into the rectangle ({:g} m x {:g} m)", s.hole_width,
                        s.hole_height, s.width, s.height),
            "make the hole smaller"};
  return {};
}

}  // namespace straytrace
