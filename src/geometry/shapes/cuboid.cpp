// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cuboid.hpp"

#include "base/input/table.hpp"
#include "geometry/drawing.hpp"

namespace straytrace::geometry {

std::span<Key<Cuboid> const> Cuboid::keys() {
  static constexpr Key<Cuboid> keys[] = {
      {"width", &Cuboid::width, dim::length, required, 1e-6, 1e5, "full size along the x axis of the shape"},
      {"height", &Cuboid::height, dim::length, required, 1e-6, 1e5, "full size along its y axis"},
      {"depth", &Cuboid::depth, dim::length, required, 1e-6, 1e5, "full size along its axis"},
  };
  return keys;
}

Drawing Cuboid::drawing() const {
  Drawing d;
  Vec3 const e[3] = {width * e1, height * e2, depth * axis};
  for (int i = 0; i < 3; ++i)
    for (double const side : {-0.5, 0.5}) {
      auto const first = std::uint32_t(d.points.size());
      for (double const x : {-0.5, 0.5})
        for (double const y : {-0.5, 0.5})
          d.points.push_back(centre + side * e[i] + x * e[(i + 1) % 3] + y * e[(i + 2) % 3]);
      d.triangles.push_back({first, first + 1, first + 2});
      d.triangles.push_back({first + 1, first + 3, first + 2});
    }
  return d;
}

}  // namespace straytrace::geometry
