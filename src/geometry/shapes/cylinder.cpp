// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cylinder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/table.hpp"
#include "geometry/drawing.hpp"

namespace straytrace::geometry {

std::span<Key<Cylinder> const> Cylinder::keys() {
  static constexpr Key<Cylinder> keys[] = {
      {"radius", &Cylinder::radius, dim::length, required, 1e-6, 1e3, "of the wall"},
      {"from", &Cylinder::from, dim::length, required, -1e6, 1e6,
       "positions of the ends along the axis, relative to 'at'"},
      {"to", &Cylinder::to, dim::length, required, -1e6, 1e6, "positions of the ends along the axis, relative to 'at'"},
  };
  return keys;
}

ShapeComplaint Cylinder::impossible() const {
  if (from >= to)
    return {fmt::format("the cylinder ends ({:g} m) before it starts ({:g} m)", to, from),
            "make 'from' smaller than 'to'"};
  return {};
}

SurfaceCurvature Cylinder::curvature_at(Vec3 p) const {
  Vec3 const outward = normal(p);
  return SurfaceCurvature::revolved(axis, outward, outward, -1 / radius, 0);
}

std::span<Key<CutCylinder> const> CutCylinder::keys() {
  using Shape = CutCylinder;
  static constexpr Key<Shape> keys[] = {
      {"radius", &Shape::radius, dim::length, required, 1e-6, 1e3, "of the wall"},
      {"from", &Shape::from, dim::length, required, -1e6, 1e6,
       "position of the straight end along the axis, relative to 'at'"},
      {"to", &Shape::end, dim::length, required, -1e6, 1e6, "position where the cut crosses the axis"},
      {"tilt", &Shape::tilt, dim::angle, 0, -1.4, 1.4, "of the cut; positive: the wall is longer on the side of +x"},
  };
  return keys;
}

ShapeComplaint CutCylinder::impossible() const {
  if (end - radius * std::fabs(std::tan(tilt)) < from)
    return {fmt::format("the cut through {:g} m goes below the start of the wall ({:g} m)", end, from),
            "raise 'to' or lower the tilt"};
  return {};
}

// A hole takes the integral of 2 R asin(x/R) over its height, with x = a cos(t), z = a sin(t): even and periodic in t,
// so that the midpoint rule converges exponentially as long as the hole is narrower than the wall.
void PiercedCylinder::place(Pose const& pose) {
  Cylinder::place(pose);
  e1 = pose.e1;
  e2 = pose.e2;
  constexpr int steps = 4096;
  double one_hole = 0;
  for (int i = 0; i < steps; ++i) {
    double const x = hole_radius * std::cos(pi * ((i + 0.5) / steps - 0.5));
    one_hole += 2 * radius * std::asin(std::min(1.0, x / radius)) * x * pi / steps;
  }
  surface = Cylinder::area() - holes * one_hole;
}

std::span<Key<PiercedCylinder> const> PiercedCylinder::keys() {
  using Shape = PiercedCylinder;
  static constexpr Key<Shape> keys[] = {
      {"radius", &Shape::radius, dim::length, required, 1e-6, 1e3, "of the wall"},
      {"from", &Shape::from, dim::length, required, -1e6, 1e6,
       "positions of the ends along the axis, relative to 'at'"},
      {"to", &Shape::to, dim::length, required, -1e6, 1e6, "positions of the ends along the axis, relative to 'at'"},
      {"hole_radius", &Shape::hole_radius, dim::length, required, 1e-7, 1e3, "of each hole"},
      {"hole_height", &Shape::hole_height, dim::length, required, -1e6, 1e6,
       "position of the centres of the holes along the axis"},
      {"hole_azimuth", &Shape::hole_azimuth, dim::angle, 0, -2 * pi, 2 * pi,
       "of the first hole, from the x axis of the shape"},
      {"holes", &Shape::holes, dim::plain, 1, 1, 10000, "number of holes, equally spaced in azimuth"},
  };
  return keys;
}

ShapeComplaint PiercedCylinder::impossible() const {
  if (ShapeComplaint const wall = Cylinder::impossible(); !wall.what.empty()) return wall;
  if (hole_radius > 0.99 * radius)
    return {fmt::format("a hole of radius {:g} m in a wall of radius {:g} m", hole_radius, radius),
            "make hole_radius smaller than 0.99 radius"};
  if (hole_height - hole_radius < from || hole_height + hole_radius > to)
    return {fmt::format("the holes reach from {:g} m to {:g} m along the axis, beyond the wall",
                        hole_height - hole_radius, hole_height + hole_radius),
            "move them, or split the wall into parts"};
  if (holes != std::floor(holes)) return {fmt::format("{:g} holes", holes), "write a whole number"};
  if (holes > 1 && std::asin(hole_radius / radius) > pi / holes)
    return {fmt::format("{:g} holes of radius {:g} m overlap", holes, hole_radius), "use fewer or smaller holes"};
  return {};
}

Drawing PiercedCylinder::drawing() const {  // cells of a sixth of the holes' radius at their height
  constexpr std::uint32_t rows = 14;
  double const low = std::max(from, hole_height - hole_radius), cell = hole_radius / 6;
  double const high = std::min(to, hole_height + hole_radius);
  auto const columns = std::uint32_t(std::clamp(std::ceil(2 * pi * radius / cell), 48.0, 480.0));
  Drawing d = Drawing::grid(rows, columns, true, [&](double u, double v) {
    double const part = (u * rows - 1) / (rows - 2), z = u == 0 ? from : u == 1 ? to : low + part * (high - low);
    return origin + z * axis + (radius * std::cos(2 * pi * v)) * e1 + (radius * std::sin(2 * pi * v)) * e2;
  });
  std::erase_if(d.triangles, [&](auto const& t) {
    Vec3 const middle = (1.0 / 3) * (d.points[t[0]] + d.points[t[1]] + d.points[t[2]]) - origin;
    double const z = dot(middle, axis);
    return in_hole(middle - z * axis, z);
  });
  return d;
}

}  // namespace straytrace::geometry
