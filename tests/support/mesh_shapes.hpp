// SPDX-License-Identifier: BSD-3-Clause
// Closed meshes for tests; triangles counter-clockwise seen from outside.
#pragma once

#include <memory>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "geometry/mesh/triangle_mesh.hpp"

namespace straytrace::testing {

struct Soup {
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;
};

// The arrays live as long as the program: tests are short.
inline TriangleMesh mesh_of(Soup const& soup, Pose const& pose, double unit = 1) {
  static Storage storage;
  TriangleMesh mesh;
  mesh.unit = unit;
  mesh.content = prepare_mesh(soup.vertices, soup.triangles, storage);
  mesh.place(pose);
  return mesh;
}

// The crossing found by testing every triangle.
inline Crossing crossing_by_force(TriangleMesh const& mesh, Ray const& ray, std::uint32_t leaving) {
  Ray const local = mesh.in_file(ray);
  TriangleMesh::Search search(mesh, local.origin, local.dir, ray.t_max, leaving);
  for (std::uint32_t i = 0; i < mesh.content.triangles.size; ++i)
    search.try_triangle(i, mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2));
  return search.result();
}

// About a unit sphere, with bumps; `rings` rings and twice as many sectors.
inline Soup bumpy(int rings, double bump) {
  Soup s;
  int const sectors = 2 * rings;
  auto const add = [&](int i, int j) {
    SinCos const a = sincos_turn(0.5 * i / rings), b = sincos_turn(double(j) / sectors);
    double const r = 1 + bump * a.sin * sincos_turn(3.5 * i / rings).sin * sincos_turn(5.0 * j / sectors).sin;
    s.vertices.push_back({float(r * a.sin * b.cos), float(r * a.sin * b.sin), float(r * a.cos)});
  };
  add(0, 0);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) add(i, j);
  add(rings, 0);
  auto const number = [&](int i, int j) -> std::uint32_t {
    if (i == 0 || i == rings) return i == 0 ? 0 : std::uint32_t(s.vertices.size() - 1);
    return std::uint32_t(1 + (i - 1) * sectors + j % sectors);
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      if (i > 0) s.triangles.push_back({{number(i, j), number(i + 1, j), number(i, j + 1)}});
      if (i < rings - 1) s.triangles.push_back({{number(i, j + 1), number(i + 1, j), number(i + 1, j + 1)}});
    }
  return s;
}

// The surface of a set of unit cells about the origin; holds(i, j, k) is true for cells inside.
template <class Inside>
Soup cells(int from, int to, Inside holds) {
  Soup s;
  auto const vertex = [&](int const(&p)[3]) {
    MeshVertex const v{float(p[0]) - 0.5f, float(p[1]) - 0.5f, float(p[2]) - 0.5f};
    for (std::uint32_t i = 0; i < s.vertices.size(); ++i)
      if (s.vertices[i] == v) return i;
    s.vertices.push_back(v);
    return std::uint32_t(s.vertices.size() - 1);
  };
  int c[3];
  for (c[0] = from; c[0] <= to; ++c[0])
    for (c[1] = from; c[1] <= to; ++c[1])
      for (c[2] = from; c[2] <= to; ++c[2])
        for (int axis = 0; axis < 3; ++axis)
          for (int side = 0; side < 2; ++side) {
            int n[3] = {c[0], c[1], c[2]};
            n[axis] += side ? 1 : -1;
            if (!holds(c[0], c[1], c[2]) || holds(n[0], n[1], n[2])) continue;
            int const u = (axis + 1) % 3, v = (axis + 2) % 3;
            int p[4][3];
            for (int k = 0; k < 4; ++k) {
              for (int a = 0; a < 3; ++a) p[k][a] = c[a];
              p[k][axis] += side;
              p[k][u] += k == 1 || k == 2;
              p[k][v] += k >= 2;
            }
            std::uint32_t const q[4] = {vertex(p[0]), vertex(p[1]), vertex(p[2]), vertex(p[3])};
            if (side) {
              s.triangles.push_back({{q[0], q[1], q[2]}});
              s.triangles.push_back({{q[0], q[2], q[3]}});
            } else {
              s.triangles.push_back({{q[0], q[2], q[1]}});
              s.triangles.push_back({{q[0], q[3], q[2]}});
            }
          }
  return s;
}
// Side 1 m, 12 triangles, area 6.
inline Soup cube() {
  return cells(0, 0, [](int i, int j, int k) { return i == 0 && j == 0 && k == 0; });
}
// A cube with a cube on each face: concave and convex edges, coplanar neighbours.
inline Soup cross_shaped() {
  return cells(-1, 1, [](int i, int j, int k) { return std::abs(i) + std::abs(j) + std::abs(k) <= 1; });
}

}  // namespace straytrace::testing
