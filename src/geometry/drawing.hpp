// SPDX-License-Identifier: BSD-3-Clause
// Shapes as triangles, for pictures and exports; nothing is traced against them. All corners lie on the shape; the
// triangles between them cut its curves short: 48 around an axis leave out 0.3 % of a circle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/math/vec3.hpp"

namespace straytrace::geometry {

struct Drawing {
  static constexpr std::uint32_t around = 48, along_curve = 8, across_ball = 16;  // cells of a curve

  std::vector<Vec3> points;  // m, in the frame of the shape's pose
  std::vector<std::array<std::uint32_t, 3>> triangles;

  double area_of(std::array<std::uint32_t, 3> const& t) const {  // m^2
    return 0.5 * length(cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]));
  }
  double area() const {
    double sum = 0;
    for (auto const& t : triangles) sum += area_of(t);
    return sum;
  }
  void drop_collapsed() {  // triangles without area, as around the pole of a disk
    double const least = 1e-12 * area() / double(std::max<std::size_t>(triangles.size(), 1));
    std::erase_if(triangles, [&](auto const& t) { return !(area_of(t) > least); });
  }

  // Corners in `rows` + 1 rows of `columns`; a ring closes on itself. `place(u, v)` with u along, v around in [0, 1].
  // Without collapsed triangles.
  template <class Place>
  static Drawing grid(std::uint32_t rows, std::uint32_t columns, bool ring, Place const& place) {
    Drawing d;
    std::uint32_t const width = ring ? columns : columns + 1;
    for (std::uint32_t i = 0; i <= rows; ++i)
      for (std::uint32_t j = 0; j < width; ++j) d.points.push_back(place(double(i) / rows, double(j) / columns));
    for (std::uint32_t i = 0; i < rows; ++i)
      for (std::uint32_t j = 0; j < columns; ++j) {
        std::uint32_t const next = ring ? (j + 1) % columns : j + 1;
        std::uint32_t const a = i * width + j, b = i * width + next, c = a + width, e = b + width;
        d.triangles.push_back({a, b, c});
        d.triangles.push_back({b, e, c});
      }
    d.drop_collapsed();
    return d;
  }
};

// A shape has `drawing()`, or its `sample` maps the unit square onto it without a jump, with the second number around;
// then `drawn_rows` is the number of rows along the first.
template <class Shape>
Drawing drawing_of(Shape const& s) {
  if constexpr (requires { s.drawing(); }) {
    return s.drawing();
  } else {
    std::uint32_t rows = Drawing::across_ball;
    if constexpr (requires { Shape::drawn_rows; }) rows = Shape::drawn_rows;
    return Drawing::grid(rows, Drawing::around, true, [&](double u, double v) { return s.sample(u, v); });
  }
}

}  // namespace straytrace::geometry
