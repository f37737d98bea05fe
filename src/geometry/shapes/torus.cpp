// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/torus.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/input/table.hpp"
#include "geometry/drawing.hpp"

namespace straytrace::geometry {

std::span<Key<Torus> const> Torus::keys() {
  static constexpr Key<Torus> keys[] = {
      {"major_radius", &Torus::major_radius, dim::length, required, 1e-6, 1e3,
       "from the axis to the centre of the tube"},
      {"minor_radius", &Torus::minor_radius, dim::length, required, 1e-7, 1e3,
       "of the tube; smaller than the major radius"},
  };
  return keys;
}

ShapeComplaint Torus::impossible() const {
  if (minor_radius >= major_radius)
    return {fmt::format("the tube ({:g} m) is not thinner than the ring ({:g} m): the torus would intersect itself",
                        minor_radius, major_radius),
            "make minor_radius smaller than major_radius"};
  if (minor_radius < 1e-4 * major_radius)
    return {fmt::format("the tube ({:g} m) is thinner than 1e-4 of the ring ({:g} m)", minor_radius, major_radius),
            "use a thin cylinder or a narrow ring, since the roots would lose precision"};
  return {};
}

SurfaceCurvature Torus::curvature_at(Vec3 p) const {
  Vec3 const o = p - centre, across = o - dot(o, axis) * axis, n = normal(p);
  double const rho = length(across);
  Vec3 const outward = (1 / rho) * across;
  return SurfaceCurvature::revolved(axis, outward, n, -dot(outward, n) / rho, -1 / minor_radius);
}

Drawing Torus::drawing() const {
  Frame const f = Frame::around(axis);
  return Drawing::grid(Drawing::around / 2, Drawing::around, true, [&](double u, double v) {
    double const rho = major_radius + minor_radius * std::cos(2 * pi * u);
    return centre + (rho * std::cos(2 * pi * v)) * f.e1 + (rho * std::sin(2 * pi * v)) * f.e2 +
           (minor_radius * std::sin(2 * pi * u)) * axis;
  });
}

}  // namespace straytrace::geometry
