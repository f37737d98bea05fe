// SPDX-License-Identifier: BSD-3-Clause
// The input keys of every shape: one list per shape, next to it.
#pragma once

#include <span>

#include "base/input/table.hpp"
#include "geometry/shape_types.hpp"

namespace straytrace {

template <class Shape>
std::span<Key<Shape> const> keys_of();
template <>
std::span<Key<Disk> const> keys_of<Disk>();
template <>
std::span<Key<Cap> const> keys_of<Cap>();
template <>
std::span<Key<Cylinder> const> keys_of<Cylinder>();
template <>
std::span<Key<Cone> const> keys_of<Cone>();
template <>
std::span<Key<Sphere> const> keys_of<Sphere>();
template <>
std::span<Key<Conic> const> keys_of<Conic>();
template <>
std::span<Key<Rectangle> const> keys_of<Rectangle>();
template <>
std::span<Key<Ellipse> const> keys_of<Ellipse>();
template <>
std::span<Key<Polygon> const> keys_of<Polygon>();
template <>
std::span<Key<Cuboid> const> keys_of<Cuboid>();
template <>
std::span<Key<Torus> const> keys_of<Torus>();
template <>
std::span<Key<PiercedCylinder> const> keys_of<PiercedCylinder>();
template <>
std::span<Key<SerratedCone> const> keys_of<SerratedCone>();
template <>
std::span<Key<Zone> const> keys_of<Zone>();
template <>
std::span<Key<CutCylinder> const> keys_of<CutCylinder>();

// What the key ranges cannot say: empty when the shape can be built, otherwise what is wrong and what to do.
struct ShapeComplaint {
  std::string what, suggestion;
};
ShapeComplaint impossible(Disk const&);
ShapeComplaint impossible(Cap const&);
ShapeComplaint impossible(Cylinder const&);
ShapeComplaint impossible(Cone const&);
ShapeComplaint impossible(Sphere const&);
ShapeComplaint impossible(Conic const&);
ShapeComplaint impossible(Rectangle const&);
ShapeComplaint impossible(Ellipse const&);
ShapeComplaint impossible(Polygon const&);
ShapeComplaint impossible(Cuboid const&);
ShapeComplaint impossible(Torus const&);
ShapeComplaint impossible(PiercedCylinder const&);
ShapeComplaint impossible(SerratedCone const&);
ShapeComplaint impossible(Zone const&);
ShapeComplaint impossible(CutCylinder const&);

}  // namespace straytrace
