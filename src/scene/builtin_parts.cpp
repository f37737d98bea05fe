// SPDX-License-Identifier: BSD-3-Clause
#include "scene/merge.hpp"

namespace straytrace {

// radius_of_curvature 0 is flat; positive is concave seen from the side the axis points to.
char const* const builtin_parts = R"(straytrace: 1
parts:
  mirror:
    params: {radius: 17.5 cm, radius_of_curvature: 0 m}
    faces:
      front: {shape: {cap: {curvature: curvature(radius_of_curvature), outer_radius: radius}}}
)";

}  // namespace straytrace
