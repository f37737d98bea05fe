// SPDX-License-Identifier: BSD-3-Clause
// What the search structure has to know of a shape.
#pragma once

#include "geometry/shape_types.hpp"
#include "world/search/search.hpp"

namespace straytrace {
namespace search_item_detail {

inline bool is_z_axis(Vec3 at, Vec3 axis) {
  return at.x == 0 && at.y == 0 && axis.x == 0 && axis.y == 0 && std::fabs(axis.z) == 1;
}
inline void set_plain(Disk const& s, SearchItem& item) {
  if (!is_z_axis(s.centre, s.axis)) return;
  item.plain_kind = TubeArrays::plain_disk;
  item.plain = {s.centre.z, s.inner_radius * s.inner_radius, s.outer_radius * s.outer_radius, 0};
}
inline void set_plain(Cylinder const& s, SearchItem& item) {
  if (!is_z_axis(s.origin, s.axis) || s.axis.z < 0) return;
  item.plain_kind = TubeArrays::plain_wall;
  item.plain = {s.origin.z, s.radius * s.radius, s.from, s.to};
}

}  // namespace search_item_detail

// All but `ref`.
template <class Shape>
SearchItem search_item(Shape const& shape) {
  SearchItem item;
  item.box = shape.bounds();
  item.reference = shape.reference();
  item.axis = shape.axis;
  shape.extent(item.low, item.high, item.r_min, item.r_max);
  using search_item_detail::set_plain;
  if constexpr (requires { set_plain(shape, item); }) set_plain(shape, item);
  return item;
}

}  // namespace straytrace
