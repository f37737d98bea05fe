// SPDX-License-Identifier: BSD-3-Clause
// Shapes as triangles, for pictures and exports; nothing is traced against them. All corners lie on the shape; the
// triangles between them cut its curves short: 48 around an axis leave out 0.3 % of a circle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/shape_types.hpp"

namespace straytrace {

struct Drawing {
  std::vector<Vec3> points;  // m, in the frame of the shape's pose
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double area() const;  // m^2
};

template <class Shape>
Drawing drawing_of(Shape const&);
template <>
Drawing drawing_of(Disk const&);
template <>
Drawing drawing_of(Cap const&);
template <>
Drawing drawing_of(Cylinder const&);
template <>
Drawing drawing_of(Cone const&);
template <>
Drawing drawing_of(Sphere const&);
template <>
Drawing drawing_of(Conic const&);
template <>
Drawing drawing_of(Rectangle const&);
template <>
Drawing drawing_of(Ellipse const&);
template <>
Drawing drawing_of(Polygon const&);
template <>
Drawing drawing_of(Cuboid const&);
template <>
Drawing drawing_of(Torus const&);
template <>
Drawing drawing_of(PiercedCylinder const&);
template <>
Drawing drawing_of(SerratedCone const&);
template <>
Drawing drawing_of(Zone const&);
template <>
Drawing drawing_of(CutCylinder const&);
template <>
Drawing drawing_of(TriangleMesh const&);
template <>
Drawing drawing_of(CadFace const&);

}  // namespace straytrace
