// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/cylinder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "geometry/keys.hpp"

namespace straytrace {

template <>
std::span<Key<Cylinder> const> keys_of<Cylinder>() {
  static constexpr Key<Cylinder> keys[] = {
      {"radius", &Cylinder::radius, dim::length, required, 1e-6, 1e3, "radius of the wall"},
      {"from", &Cylinder::from, dim::length, required, -1e6, 1e6, "start along the axis"},
      {"to", &Cylinder::to, dim::length, required, -1e6, 1e6, "end along the axis"},
  };
  return keys;
}

ShapeComplaint impossible(Cylinder const& s) {
  if (s.from >= s.to)
    return {fmt::format("the cylinder ends ({:g} m) before it starts ({:g} m)", s.to, s.from),
            "make 'from' smaller than 'to'"};
  return {};
}

template <>
std::span<Key<CutCylinder> const> keys_of<CutCylinder>() {
  using Shape = CutCylinder;
  static constexpr Key<Shape> keys[] = {
      {"radius", &Shape::radius, dim::length, required, 1e-6, 1e3, "radius of the wall"},
      {"from", &Shape::from, dim::length, required, -1e6, 1e6, "start along the axis"},
      {"to", &Shape::end, dim::length, required, -1e6, 1e6, "where the cut crosses the axis"},
      {"tilt", &Shape::tilt, dim::angle, 0, -1.4, 1.4, "of the cut; positive: longer on the side of +x"},
  };
  return keys;
}

ShapeComplaint impossible(CutCylinder const& s) {
  if (s.end - s.radius * std::fabs(std::tan(s.tilt)) < s.from)
    return {fmt::format("the cut through {:g} m goes below the start of the wall ({:g} m)", s.end, s.from),
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

template <>
std::span<Key<PiercedCylinder> const> keys_of<PiercedCylinder>() {
  using Shape = PiercedCylinder;
  static constexpr Key<Shape> keys[] = {
      {"radius", &Shape::radius, dim::length, required, 1e-6, 1e3, "radius of the wall"},
      {"from", &Shape::from, dim::length, required, -1e6, 1e6, "start along the axis"},
      {"to", &Shape::to, dim::length, required, -1e6, 1e6, "end along the axis"},
      {"hole_radius", &Shape::hole_radius, dim::length, required, 1e-7, 1e3, "of the drill"},
      {"hole_height", &Shape::hole_height, dim::length, required, -1e6, 1e6,
       "of the middle of the holes, along the axis"},
      {"hole_azimuth", &Shape::hole_azimuth, dim::angle, 0, -2 * pi, 2 * pi, "of the first hole, from the x axis"},
      {"holes", &Shape::holes, dim::plain, 1, 1, 10000, "number of holes, spread evenly around"},
  };
  return keys;
}

ShapeComplaint impossible(PiercedCylinder const& s) {
  if (s.from >= s.to)
    return {fmt::format("the cylinder ends ({:g} m) before it starts ({:g} m)", s.to, s.from),
            "make 'from' smaller than 'to'"};
  if (s.hole_radius > 0.99 * s.radius)
    return {fmt::format("a hole of radius {:g} m in a wall of radius {:g} m", s.hole_radius, s.radius),
            "make hole_radius smaller than 0.99 radius"};
  if (s.hole_height - s.hole_radius < s.from || s.hole_height + s.hole_radius > s.to)
    return {fmt::format("the holes reach from {:g} m to {:g} m along the axis, beyond the wall",
                        s.hole_height - s.hole_radius, s.hole_height + s.hole_radius),
            "move them, or split the wall into parts"};
  if (s.holes != std::floor(s.holes)) return {fmt::format("{:g} holes", s.holes), "write a whole number"};
  if (s.holes > 1 && std::asin(s.hole_radius / s.radius) > pi / s.holes)
    return {fmt::format("{:g} holes of radius {:g} m overlap", s.holes, s.hole_radius), "make fewer or smaller holes"};
  return {};
}

}  // namespace straytrace
