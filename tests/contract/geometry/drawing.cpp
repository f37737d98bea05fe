// SPDX-License-Identifier: BSD-3-Clause
// Triangles of every shape for pictures: their corners lie on it, and they cover its area.
#include "geometry/drawing.hpp"

#include <gtest/gtest.h>

#include "contract/geometry/instances.hpp"

namespace straytrace::testing::geometry_drawing {
namespace {

// Corners on a circle of n points leave out 1 - sin(2 pi/n)/(2 pi/n) of it: 0.3 % of 48, and 2 % on balls and bowls. A
// hole drawn by cells of a sixth of its radius is ragged by some of them; a round hole in a polygon is small by its own
// 0.3 %, which is more of what is left.
template <class Shape>
double allowance(Shape const& s) {
  if constexpr (std::is_same_v<Shape, Polygon>)
    return 0.02 + 0.004 * pi * s.hole_radius * s.hole_radius / s.area();
  else
    return std::is_same_v<Shape, PiercedCylinder> ? 0.06 : 0.02;
}

template <class Shape>
bool fits(Shape const& s, Drawing const& d) {
  for (Vec3 const& p : d.points)
    if constexpr (!HasPieces<Shape>)
      if (length(s.project(p) - p) > 1e-9 * (1 + length(p))) return false;
  return std::fabs(d.area() / s.area() - 1) < allowance(s);
}

template <class Shape>
class Drawn : public ::testing::Test {};
TYPED_TEST_SUITE(Drawn, AllShapes);

TYPED_TEST(Drawn, CoversTheShape) {
  for (TypeParam const& s : instances<TypeParam>()) {
    Drawing const d = drawing_of(s);
    EXPECT_TRUE(fits(s, d)) << "area " << d.area() << ", of the shape " << s.area();
    EXPECT_LT(d.triangles.size(), 60000u);
    Drawing holed = d;  // negative control: a third of the triangles is missing
    holed.triangles.resize(holed.triangles.size() * 2 / 3);
    EXPECT_FALSE(fits(s, holed));
  }
}

}  // namespace
}  // namespace straytrace::testing::geometry_drawing
