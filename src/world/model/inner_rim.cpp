// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/inner_rim.hpp"

#include <cmath>
#include <type_traits>

#include "world/model/world.hpp"

namespace straytrace {
namespace {

template <class Shape>
std::optional<InnerRim> inner_rim_of(Shape const& s) {
  constexpr bool cone = std::is_base_of_v<Cone, Shape>, cap = std::is_same_v<Shape, Cap>;
  if constexpr (std::is_same_v<Shape, Disk> || cap || cone) {
    if (!(s.inner_radius > 0)) return {};
    Frame const f = Frame::around(s.axis);
    InnerRim rim{{}, s.reference(), s.axis, f.e1, f.e2, s.inner_radius, 0, 0, 0, 0};
    if constexpr (cap) rim.centre = rim.centre + s.curvature * s.depth(s.inner_radius) * s.axis;
    if constexpr (cone) rim.slope = s.cosine / s.sine;
    if constexpr (std::is_same_v<Shape, SerratedCone>) {
      rim.e1 = s.e1;
      rim.e2 = s.e2;
      rim.tooth_depth = s.tooth_depth;
      rim.teeth = s.teeth;
      rim.phase = s.phase;
    }
    return rim;
  } else {
    return {};
  }
}

}  // namespace

std::optional<InnerRim> rim_of(World const& world, SurfaceId id) {
  std::optional<InnerRim> rim =
      world.view().shapes.visit(world.surfaces()[id.value].shape, [](auto const& s) { return inner_rim_of(s); });
  if (rim) rim->surface = id;
  return rim;
}

double rim_radius(InnerRim const& rim, double azimuth) {
  if (rim.tooth_depth == 0) return rim.radius;
  double const x = (azimuth - rim.phase) / (2 * pi) * rim.teeth;
  return rim.radius + rim.tooth_depth * (1 - std::fabs(1 - 2 * (x - std::floor(x))));
}

Vec3 rim_point(InnerRim const& rim, double azimuth) {
  double const r = rim_radius(rim, azimuth);
  return rim.centre + (r - rim.radius) * rim.slope * rim.axis + r * std::cos(azimuth) * rim.e1 +
         r * std::sin(azimuth) * rim.e2;
}

}  // namespace straytrace
