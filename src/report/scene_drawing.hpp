// SPDX-License-Identifier: BSD-3-Clause
// A world as triangles, for pictures and exports: equal shapes are stored once, meshes of millions of triangles are
// simplified and marked.
#pragma once

#include <string>
#include <vector>

#include "world/model/world.hpp"

namespace straytrace::report {

struct DrawnMesh {
  std::vector<float> points;           // m, three per corner, from the place of the part
  std::vector<std::uint32_t> corners;  // three per triangle
  std::size_t of_triangles = 0;        // that the shape has; more than are drawn: thinned out
  double moved = 0;                    // m, at most, where it was
  std::size_t triangles() const { return corners.size() / 3; }
};

// Surfaces of one name with one shape, body and material on either side.
struct DrawnPart {
  std::string name, body, front, back, shape;  // front, back: material; shape: its key
  std::uint32_t mesh = 0;
  std::vector<Vec3> places;  // m
  bool clear = false;        // a measuring plane
};

struct SceneDrawing {
  std::vector<DrawnMesh> meshes;
  std::vector<DrawnPart> parts;
  Box box;                                              // m
  std::size_t triangles() const, of_triangles() const;  // of all parts: drawn, and of their shapes
};

constexpr std::size_t most_drawn_triangles = 200000;  // in all different meshes together
SceneDrawing scene_drawing(World const&, std::size_t most_triangles = most_drawn_triangles);

}  // namespace straytrace::report
