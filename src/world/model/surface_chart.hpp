// SPDX-License-Identifier: BSD-3-Clause
// The chart that suits surfaces laid over one another: polar on round ones, unrolled where they are longer than wide or
// a cylinder, else x and y across the axis.
#pragma once

#include <span>

#include "world/model/world.hpp"

namespace straytrace {

struct SurfaceChart {
  Chart chart = Chart::plane;
  MapCell whole;  // about reference() and `axis` of the shapes; contains all of them
};
SurfaceChart chart_of(WorldView const&, std::span<SurfaceId const>);

}  // namespace straytrace
