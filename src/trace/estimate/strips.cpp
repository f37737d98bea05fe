// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/strips.hpp"

#include <algorithm>
#include <cmath>

#include "trace/estimate/importance.hpp"

namespace straytrace {
namespace {

constexpr std::size_t most_edges = 256;

// Places along a long wall where the light changes: the ends of everything that stands in it, and a ladder of growing
// steps away from each lit surface and from its own ends.
std::vector<double> wall_edges(World const& world, WorldView const& view, Cylinder const& wall) {
  double const length = wall.to - wall.from;
  std::vector<double> heights;
  auto const height = [&](Vec3 p) { return dot(p - wall.origin, wall.axis) - wall.from; };
  for (Surface const& s : world.surfaces()) {
    Vec3 const at = view.shapes.visit(s.shape, [](auto const& shape) { return shape.reference(); });
    if (length2(at - wall.origin - dot(at - wall.origin, wall.axis) * wall.axis) <= wall.radius * wall.radius)
      heights.push_back(height(at));
  }
  std::vector<double> steps{0, length};
  for (Footprint const& f : world.footprints()) steps.push_back(height(f.centre));
  for (Receiver const& r : world.receivers())
    steps.push_back(height(view.shapes.visit(world.surfaces()[r.surface.value].shape,
                                             [](auto const& shape) { return shape.reference(); })));
  for (double const from : steps)
    for (double step = 0.5 * wall.radius; step < length; step *= 1.5) {
      heights.push_back(from + step);
      heights.push_back(from - step);
    }
  std::sort(heights.begin(), heights.end());
  double const least = std::max(0.2 * wall.radius, length / double(most_edges));
  std::vector<double> edges{0};
  for (double const h : heights)
    if (h > edges.back() * length + least && h < length - least) edges.push_back(h / length);
  edges.push_back(1);
  return edges;
}

template <class Shape>
std::vector<double> edges_of(World const& world, WorldView const& view, Shape const& shape) {
  if constexpr (std::is_same_v<Shape, Cylinder>)
    if (shape.to - shape.from > 2 * shape.radius) return wall_edges(world, view, shape);
  int const parts = std::is_same_v<Shape, Sphere> ? 8 : 1;
  std::vector<double> edges;
  for (int i = 0; i <= parts; ++i) edges.push_back(double(i) / parts);
  return edges;
}

}  // namespace

SteeringTables make_strips(World const& world) {
  SteeringTables tables;
  WorldView const view = world.view();
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    tables.first_of_surface.push_back(std::uint32_t(tables.strips.size()));
    view.shapes.visit(world.surfaces()[id].shape, [&](auto const& shape) {
      std::vector<double> const edges = edges_of(world, view, shape);
      for (std::size_t i = 0; i + 1 < edges.size(); ++i)
        tables.strips.push_back({{id}, edges[i], edges[i + 1], (edges[i + 1] - edges[i]) * shape.area()});
    });
  }
  tables.first_of_surface.push_back(std::uint32_t(tables.strips.size()));
  tables.sides.resize(2 * tables.strips.size());
  return tables;
}

}  // namespace straytrace
