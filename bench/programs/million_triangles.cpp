// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "scenes.hpp"

namespace straytrace::bench {
namespace {

class MeshBuilder {
 public:
  // A sheet of columns x rows quads, two triangles each; at(i, k) for 0 <= i <= columns, 0 <= k <= rows. Corners at the
  // same place are one corner. The front is on the side of (along columns) x (along rows).
  template <class At>
  void sheet(std::uint32_t columns, std::uint32_t rows, At const& at) {
    auto const first = std::uint32_t(vertices.size()), step = rows + 1;
    for (std::uint32_t i = 0; i <= columns; ++i)
      for (std::uint32_t k = 0; k <= rows; ++k) {
        Vec3 const p = at(i, k);
        vertices.push_back({float(p.x), float(p.y), float(p.z)});
      }
    for (std::uint32_t i = 0; i < columns; ++i)
      for (std::uint32_t k = 0; k < rows; ++k) {
        std::uint32_t const a = first + i * step + k, b = a + step, c = b + 1, d = a + 1;
        add(a, b, c);
        add(a, c, d);
      }
  }
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;

 private:
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (vertices[a] == vertices[b] || vertices[b] == vertices[c] || vertices[c] == vertices[a]) return;
    triangles.push_back({{a, b, c}});
  }
};

void add_body(MeshBuilder& mesh, Vec3 centre, std::uint64_t number) {
  Rng rng(4, number, 0, Stream::source);
  double const size = 0.02 + 0.02 * rng.uniform(), phase = rng.uniform();
  constexpr std::uint32_t around = 64, along = 32;
  mesh.sheet(around, along, [&](std::uint32_t i, std::uint32_t k) {
    if (k == 0 || k == along) return centre + Vec3{0, 0, k == 0 ? -size : size};
    SinCos const a = sincos_turn(double(i % around) / around), b = sincos_turn(double(k) / (2 * along));
    SinCos const bump = sincos_turn(5.0 * (i % around) / around + phase), ripple = sincos_turn(3.0 * k / along + phase);
    double const r = size * (1 + 0.15 * bump.sin * ripple.sin * b.sin * b.sin);
    return centre + r * Vec3{b.sin * a.cos, b.sin * a.sin, -b.cos};
  });
}

void add_walls(MeshBuilder& mesh, Vec3 half) {
  constexpr std::uint32_t cells = 30;
  auto const along = [](double h, std::uint32_t i) { return h * (2.0 * i / cells - 1); };
  for (int side : {-1, 1}) {  // fronts inward
    auto const wall = [&](auto const& at) {
      mesh.sheet(cells, cells, [&](std::uint32_t i, std::uint32_t k) { return side < 0 ? at(i, k) : at(k, i); });
    };
    wall([&](std::uint32_t i, std::uint32_t k) { return Vec3{along(half.x, i), along(half.y, k), side * half.z}; });
    wall([&](std::uint32_t i, std::uint32_t k) { return Vec3{side * half.x, along(half.y, i), along(half.z, k)}; });
    wall([&](std::uint32_t i, std::uint32_t k) { return Vec3{along(half.x, k), side * half.y, along(half.z, i)}; });
  }
}

}  // namespace

BenchScene million_triangles(bool reversed) { return knobbly_bodies(250, reversed); }

BenchScene knobbly_bodies(std::uint64_t bodies, bool reversed) {
  MeshBuilder mesh;
  add_walls(mesh, {0.6, 0.35, 0.35});
  for (std::uint64_t number = 0; number < bodies; ++number) {
    Rng rng(4, number, 1, Stream::source);
    auto const place = [&](std::uint64_t cell, std::uint64_t cells) {
      return 0.12 * (double(cell) - 0.5 * double(cells - 1)) + 0.02 * (rng.uniform() - 0.5);
    };
    double const x = place(number % 10, 10), y = place(number / 10 % 5, 5), z = place(number / 50, 5);
    add_body(mesh, {x, y, z}, number);
  }
  if (reversed) std::reverse(mesh.triangles.begin(), mesh.triangles.end());

  BenchScene scene;
  scene.name = "mesh";
  scene.world.add_optic({});
  for (MeshTriangle const& t : mesh.triangles) {
    Triangle& out = scene.triangles.emplace_back();
    for (int k = 0; k < 3; ++k) {
      MeshVertex const v = mesh.vertices[t.corner[k]];
      out.corner[k][0] = v.x;
      out.corner[k][1] = v.y;
      out.corner[k][2] = v.z;
    }
  }
  TriangleMesh shape;
  shape.content = prepare_mesh(std::move(mesh.vertices), std::move(mesh.triangles), scene.world.storage);
  scene.world.add_surface(shape, 0, 0, {}, {});
  scene.world.finish();
  return scene;
}

}  // namespace straytrace::bench
