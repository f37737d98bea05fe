// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/table.hpp"
#include "geometry/drawing.hpp"

namespace straytrace::geometry {

std::span<Key<Cone> const> Cone::keys() {
  static constexpr Key<Cone> keys[] = {
      {"inner_radius", &Cone::inner_radius, dim::length, required, 0, 1e3, "radius of the clear aperture"},
      {"outer_radius", &Cone::outer_radius, dim::length, required, 1e-6, 1e3, "radius of the wide end"},
      {"half_angle", &Cone::half_angle, dim::angle, required, 1e-3, pi / 2 - 1e-3,
       "between the axis and the surface, more than 0 and less than 90 deg"},
  };
  return keys;
}

ShapeComplaint Cone::impossible() const {
  if (inner_radius >= outer_radius)
    return {fmt::format("the rim ({:g} m) is not smaller than the wide end ({:g} m)", inner_radius, outer_radius),
            "make inner_radius smaller than outer_radius"};
  return {};
}

SurfaceCurvature Cone::curvature_at(Vec3 p) const {
  Vec3 const o = p - apex;
  double const rho = length(o - dot(o, axis) * axis);
  return SurfaceCurvature::revolved(axis, outward(p), normal(p), -cosine / rho, 0);
}

std::span<Key<SerratedCone> const> SerratedCone::keys() {
  using Shape = SerratedCone;
  static constexpr Key<Shape> keys[] = {
      {"inner_radius", &Shape::inner_radius, dim::length, required, 1e-6, 1e3,
       "of the tips of the teeth: the clear aperture"},
      {"outer_radius", &Shape::outer_radius, dim::length, required, 1e-6, 1e3, "of the wide end"},
      {"half_angle", &Shape::half_angle, dim::angle, required, 1e-3, pi / 2 + 1e-12,
       "between the axis and the surface; 90 deg: a flat ring"},
      {"tooth_depth", &Shape::tooth_depth, dim::length, required, 1e-9, 1e3,
       "from tip to valley, measured across the axis"},
      {"teeth", &Shape::teeth, dim::plain, required, 1, 100000, "number around the edge"},
      {"phase", &Shape::phase, dim::angle, 0, -2 * pi, 2 * pi, "azimuth of one tip, from the x axis of the shape"},
  };
  return keys;
}

ShapeComplaint SerratedCone::impossible() const {
  if (inner_radius + tooth_depth >= outer_radius)
    return {fmt::format("the valleys ({:g} m) reach beyond the wide end ({:g} m)", inner_radius + tooth_depth,
                        outer_radius),
            "make inner_radius + tooth_depth smaller than outer_radius"};
  if (teeth != std::floor(teeth)) return {fmt::format("{:g} teeth", teeth), "write a whole number"};
  if (half_angle > pi / 2 - 1e-3 && half_angle < pi / 2 - 1e-9)
    return {fmt::format("a half angle of {:.6f} deg is neither a cone nor flat", half_angle * 180 / pi),
            "write 90 deg for a flat ring, or less than 89.94 deg"};
  return {};
}

Drawing SerratedCone::drawing() const {
  auto const flanks = std::uint32_t(std::lround(2 * teeth));
  std::uint32_t const steps = std::max(1u, 2 * Drawing::around / flanks), columns = flanks * steps;
  return Drawing::grid(1, columns, true, [&](double u, double v) {
    double const a = 2 * pi * v + phase, x = std::cos(a), y = std::sin(a),
                 half = std::fabs(std::remainder(v * teeth, 1));
    double const edge = inner_radius + 2 * half * tooth_depth;
    double const rho = u > 0 ? outer_radius : edge;
    return apex + (rho * cosine / sine) * axis + (rho * x) * e1 + (rho * y) * e2;
  });
}

}  // namespace straytrace::geometry
