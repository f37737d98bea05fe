// SPDX-License-Identifier: BSD-3-Clause
// What one side of a surface does to light: a specular interface plus a sum of scatter laws. What neither is reflected,
// transmitted nor scattered is absorbed.
#pragma once

#include "base/memory/storage.hpp"
#include "optics/angle_weight.hpp"

namespace straytrace {

// How the local x axis of a surface is laid for laws with a direction on it. The axis is that of the shape.
enum class Lay : std::uint8_t { free, around, along, given };

struct Optic {
  static constexpr int most_laws = 8;
  double reflect = 0, transmit = 0;  // fixed coating: power, the same at every angle; unused with an interface
  bool has_interface = false;
  PoolRef interface;      // in SpecularTypes
  double depolarise = 1;  // share of scattered light that loses its polarisation
  Lay lay = Lay::free;    // grooves (local y) run around the axis, along it, or along `lay_direction` of the scene
  Vec3 lay_direction;
  int laws = 0;
  PoolRef law[most_laws];                     // in LawTypes
  bool through[most_laws] = {};               // the law scatters to the other side (optics/scatter/through.hpp)
  View<AngleWeight const> weight[most_laws];  // none, or one
};

}  // namespace straytrace
