// SPDX-License-Identifier: BSD-3-Clause
// The input keys of every shape: one list per shape, next to it.
#pragma once

#include <span>

#include "base/table.hpp"
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

// What the key ranges cannot say: empty when the shape can be built, otherwise what is wrong and what to do.
struct ShapeComplaint {
  std::string what, suggestion;
};
ShapeComplaint impossible(Disk const&);
ShapeComplaint impossible(Cap const&);
ShapeComplaint impossible(Cylinder const&);
ShapeComplaint impossible(Cone const&);
ShapeComplaint impossible(Sphere const&);

}  // namespace straytrace
