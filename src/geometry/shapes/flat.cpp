// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/flat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/table.hpp"
#include "geometry/drawing.hpp"

namespace straytrace::geometry {

std::span<Key<Disk> const> Disk::keys() {
  static constexpr Key<Disk> keys[] = {
      {"outer_radius", &Disk::outer_radius, dim::length, required, 1e-6, 1e3, "radius of the disk"},
      {"inner_radius", &Disk::inner_radius, dim::length, 0, 0, 1e3, "radius of the central hole"},
  };
  return keys;
}

ShapeComplaint Disk::impossible() const {
  if (inner_radius >= outer_radius)
    return {fmt::format("the hole ({:g} m) is not smaller than the disk ({:g} m)", inner_radius, outer_radius),
            "make inner_radius smaller than outer_radius"};
  return {};
}

std::span<Key<Ellipse> const> Ellipse::keys() {
  static constexpr Key<Ellipse> keys[] = {
      {"semi_x", &Ellipse::semi_x, dim::length, required, 1e-6, 1e3, "semi-axis along the x axis of the shape"},
      {"semi_y", &Ellipse::semi_y, dim::length, required, 1e-6, 1e3, "semi-axis along its y axis"},
      {"hole_x", &Ellipse::hole_x, dim::length, 0, 0, 1e3, "semi-axes of a central hole; both or none"},
      {"hole_y", &Ellipse::hole_y, dim::length, 0, 0, 1e3, "semi-axes of a central hole; both or none"},
  };
  return keys;
}

ShapeComplaint Ellipse::impossible() const {
  if ((hole_x > 0) != (hole_y > 0)) return {"the hole has only one of 'hole_x' and 'hole_y'", "give both, or none"};
  if (hole_x > semi_x || hole_y > semi_y || hole_x * hole_y >= semi_x * semi_y)
    return {fmt::format("the hole (semi-axes {:g} m, {:g} m) does not fit into the ellipse ({:g} m, {:g} m)", hole_x,
                        hole_y, semi_x, semi_y),
            "make the hole smaller; these are semi-axes, half of the full sizes"};
  return {};
}

Drawing Ellipse::drawing() const {
  return Drawing::grid(1, Drawing::around, true, [&](double u, double v) {
    double const x = hole_x + u * (semi_x - hole_x), y = hole_y + u * (semi_y - hole_y);
    return at(x * std::cos(2 * pi * v), y * std::sin(2 * pi * v));
  });
}

std::span<Key<Rectangle> const> Rectangle::keys() {
  static constexpr Key<Rectangle> keys[] = {
      {"width", &Rectangle::width, dim::length, required, 1e-6, 1e5, "full size along the x axis of the shape"},
      {"height", &Rectangle::height, dim::length, required, 1e-6, 1e5, "full size along its y axis"},
      {"hole_width", &Rectangle::hole_width, dim::length, 0, 0, 1e5, "full sizes of a central hole; both or none"},
      {"hole_height", &Rectangle::hole_height, dim::length, 0, 0, 1e5, "full sizes of a central hole; both or none"},
  };
  return keys;
}

ShapeComplaint Rectangle::impossible() const {
  if ((hole_width > 0) != (hole_height > 0))
    return {"the hole has only one of 'hole_width' and 'hole_height'", "give both, or none"};
  if (hole_width > width || hole_height > height || hole_width * hole_height >= width * height)
    return {fmt::format("the hole ({:g} m x {:g} m) does not fit into the rectangle ({:g} m x {:g} m)", hole_width,
                        hole_height, width, height),
            "make the hole smaller"};
  return {};
}

Drawing Rectangle::drawing() const {
  if (!(hole_width > 0 && hole_height > 0))
    return Drawing::grid(1, 1, false, [&](double u, double v) { return at((u - 0.5) * width, (v - 0.5) * height); });
  return Drawing::grid(1, 4, true, [&](double u, double v) {
    double const turn = 2 * pi * (v + 0.125), w = hole_width + u * (width - hole_width),
                 h = hole_height + u * (height - hole_height);
    return at(std::copysign(0.5 * w, std::cos(turn)), std::copysign(0.5 * h, std::sin(turn)));
  });
}

std::span<Key<Polygon> const> Polygon::keys() {
  static constexpr Key<Polygon> keys[] = {
      {"sides", &Polygon::sides, dim::plain, required, 0, 1000, "number of sides, at least 3; 0: a circle"},
      {"radius", &Polygon::radius, dim::length, required, 1e-6, 1e3, "from the centre to the corners"},
      {"rotation", &Polygon::rotation, dim::angle, 0, -2 * pi, 2 * pi,
       "azimuth of the first corner, from the x axis of the shape"},
      {"hole_sides", &Polygon::hole_sides, dim::plain, 0, 0, 1000, "of the hole; 0: a circle"},
      {"hole_radius", &Polygon::hole_radius, dim::length, 0, 0, 1e3, "to the corners of the hole; 0: no hole"},
      {"hole_rotation", &Polygon::hole_rotation, dim::angle, 0, -2 * pi, 2 * pi, "azimuth of its first corner"},
  };
  return keys;
}

namespace {

// Outlines are convex: one lies within the other when its corners do, a circle when the sides keep clear of it.
bool fits(RegularOutline const& hole, RegularOutline const& plate) {
  if (plate.sides == 0) return hole.radius < plate.radius;
  if (hole.sides == 0) return hole.radius < plate.apothem;
  for (double k = 0; k < hole.sides; ++k) {
    SinCos const a = sincos_turn(k / hole.sides + hole.rotation / (2 * pi));
    if (!plate.contains(hole.radius * a.cos, hole.radius * a.sin)) return false;
  }
  return hole.area() < plate.area();
}

// Distance from the centre to a regular outline at an azimuth, m.
double reach(RegularOutline const& o, double azimuth) {
  if (o.sides == 0) return o.radius;
  double const side = 2 * pi / o.sides, x = (azimuth - o.rotation) / side;
  return o.apothem / std::cos((x - std::floor(x) - 0.5) * side);
}

}  // namespace

ShapeComplaint Polygon::impossible() const {
  for (double number : {sides, hole_sides})
    if (number != std::floor(number) || (number > 0 && number < 3))
      return {fmt::format("a polygon cannot have {:g} sides", number),
              "write a whole number from 3 on, or 0 for a circle"};
  Polygon placed = *this;
  placed.place({});
  if (hole_radius > 0 && !fits(placed.hole(), placed.outline()))
    return {fmt::format("the hole ({:g} m) does not fit into the polygon ({:g} m)", hole_radius, radius),
            "make hole_radius smaller; both radii reach to the corners"};
  return {};
}

Drawing Polygon::drawing() const {
  std::vector<double> azimuths;  // of all corners: between them both outlines are straight
  for (RegularOutline const& o : {outline(), hole()}) {
    double const corners = o.sides == 0 ? Drawing::around : o.sides;
    for (double k = 0; k < corners && o.radius > 0; ++k) {
      double const turn = o.rotation / (2 * pi) + k / corners;
      azimuths.push_back(2 * pi * (turn - std::floor(turn)));
    }
  }
  std::ranges::sort(azimuths);
  auto const columns = std::uint32_t(azimuths.size());
  return Drawing::grid(1, columns, true, [&](double u, double v) {
    double const a = azimuths[std::uint32_t(std::lround(v * columns)) % columns];
    double const inner = hole_radius > 0 ? reach(hole(), a) : 0, rho = u > 0 ? reach(outline(), a) : inner;
    return at(rho * std::cos(a), rho * std::sin(a));
  });
}

}  // namespace straytrace::geometry
