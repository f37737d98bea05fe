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
std::vector<double> wall_edges(World const& world, std::vector<Vec3> const& places, Cylinder const& wall) {
  double const length = wall.to - wall.from;
  std::vector<double> heights;
  auto const height = [&](Vec3 p) { return dot(p - wall.origin, wall.axis) - wall.from; };
  for (Vec3 const at : places)
    if (length2(at - wall.origin - dot(at - wall.origin, wall.axis) * wall.axis) <= wall.radius * wall.radius)
      heights.push_back(height(at));
  std::vector<double> steps{0, length};
  for (Footprint const& f : world.footprints()) steps.push_back(height(f.centre));
  for (Receiver const& r : world.receivers()) steps.push_back(height(places[r.surface.value]));
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

// Parts of about equal area whose edges lie between triangles; all meshes of a scene share `most`.
std::vector<double> mesh_edges(TriangleMesh const& mesh, std::size_t meshes) {
  constexpr std::size_t most = 512, most_of_one = 64, least_triangles = 4;
  std::size_t const triangles = mesh.content.in_order.size;
  std::size_t const parts = std::max<std::size_t>(
      1, std::min({most / std::max<std::size_t>(meshes, 1), most_of_one, triangles / least_triangles}));
  double const* const before = &mesh.content.area_before[0];
  double const area = before[triangles];
  std::vector<double> edges{0};
  for (std::size_t i = 1; i < parts; ++i) {
    double const edge = *std::lower_bound(before, before + triangles, area * double(i) / double(parts)) / area;
    if (edge > edges.back() && edge < 1) edges.push_back(edge);
  }
  edges.push_back(1);
  return edges;
}

template <class Shape>
std::vector<double> edges_of(World const& world, std::vector<Vec3> const& places, Shape const& shape) {
  if constexpr (std::is_same_v<Shape, Cylinder>)
    if (shape.to - shape.from > 2 * shape.radius) return wall_edges(world, places, shape);
  if constexpr (std::is_same_v<Shape, TriangleMesh>)
    return mesh_edges(shape, std::get<View<TriangleMesh const>>(world.view().shapes.arrays).size);
  int const parts = std::is_same_v<Shape, Sphere> ? 8 : 1;
  std::vector<double> edges;
  for (int i = 0; i <= parts; ++i) edges.push_back(double(i) / parts);
  return edges;
}

}  // namespace

SteeringTables make_strips(World const& world) {
  SteeringTables tables;
  WorldView const view = world.view();
  std::vector<Vec3> places;  // of the surfaces
  for (Surface const& s : world.surfaces())
    places.push_back(view.shapes.visit(s.shape, [](auto const& shape) { return shape.reference(); }));
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    tables.first_of_surface.push_back(std::uint32_t(tables.strips.size()));
    view.shapes.visit(world.surfaces()[id].shape, [&](auto const& shape) {
      std::vector<double> const edges = edges_of(world, places, shape);
      for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        auto const number = std::uint32_t(tables.strips.size());
        double const area = (edges[i + 1] - edges[i]) * shape.area();
        tables.strips.push_back({{id}, edges[i], edges[i + 1], area, number});
        tables.patches.push_back({area, number, 1});
        tables.members.push_back({number, 0});
      }
    });
  }
  tables.first_of_surface.push_back(std::uint32_t(tables.strips.size()));
  tables.sides.resize(2 * tables.patches.size());
  return tables;
}

Box bounds_of(WorldView const& view, Strip const& strip) {
  constexpr int steps = 4;
  Box box;
  view.shapes.visit(view.surfaces[strip.surface.value].shape, [&](auto const& shape) {
    if (strip.u_low == 0 && strip.u_high == 1) {
      box = shape.bounds();
      return;
    }
    double const width = strip.u_high - strip.u_low;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j < steps; ++j)
        box.add(sample_in_strip(shape, strip.u_low + width * i / steps, double(j) / steps).point);
  });
  return box;
}

}  // namespace straytrace
