// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/disk.hpp"

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

}  // namespace straytrace
