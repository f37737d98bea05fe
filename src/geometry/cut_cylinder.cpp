// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cut_cylinder.hpp"

#include <fmt/format.h>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<CutCylinder> const> keys_of<CutCylinder>() {
  using Shape = CutCylinder;
  static constexpr Key<Shape> keys[] = {
      {"radius", &Shape::radius, dim::length, required, 1e-6, 1e3, "radius of the wall"},
      {"from", &Shape::from, dim::length, required, -1e6, 1e6, "start along the axis"},
      {"to", &Shape::end, dim::length, required, -1e6, 1e6, "where the cut crosses the axis"},
      {"tilt", &Shape::tilt, dim::angle, 0, -1.4, 1.4, "of the cut; positive: longer on the side of +x"},
  };
  return keys;
}

ShapeComplaint impossible(CutCylinder const& s) {
  if (s.end - s.radius * std::fabs(std::tan(s.tilt)) < s.from)
    return {fmt::format("the cut through {:g} m goes below the start of the wall ({:g} m)", s.end, s.from),
            "raise 'to' or lower the tilt"};
  return {};
}

}  // namespace straytrace
