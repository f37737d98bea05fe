// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/mesh/smooth_normals.hpp"

#include <bit>
#include <cmath>
#include <stdexcept>

namespace straytrace::geometry {
namespace {

Vec3 corner(MeshContent const& mesh, std::size_t triangle, int i) {
  return exact(mesh.vertices[mesh.triangles[triangle].corner[i]]);
}
Vec3 facet(MeshContent const& mesh, std::size_t triangle) {
  return unit(facet_normal(corner(mesh, triangle, 0), corner(mesh, triangle, 1), corner(mesh, triangle, 2)));
}
MeshVertex rounded(Vec3 v) { return {float(v.x), float(v.y), float(v.z)}; }

double angle_at(MeshContent const& mesh, std::size_t triangle, int i) {
  Vec3 const here = corner(mesh, triangle, i), a = corner(mesh, triangle, (i + 1) % 3) - here,
             b = corner(mesh, triangle, (i + 2) % 3) - here;
  return std::atan2(length(cross(a, b)), dot(a, b));
}

// Corners of triangles, 3 t + i, by the vertex there: those of vertex v are list[first[v]] to list[first[v + 1] - 1].
struct Corners {
  std::vector<std::uint32_t> first, list;

  explicit Corners(MeshContent const& mesh) : first(mesh.vertices.size + 1), list(3 * mesh.triangles.size) {
    for (std::size_t t = 0; t < mesh.triangles.size; ++t)
      for (std::uint32_t v : mesh.triangles[t].corner) ++first[v + 1];
    for (std::size_t v = 0; v < mesh.vertices.size; ++v) first[v + 1] += first[v];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size; ++t)
      for (int i = 0; i < 3; ++i) list[next[mesh.triangles[t].corner[i]]++] = std::uint32_t(3 * t) + std::uint32_t(i);
  }
};

// Keeps the normals and makes them part of the content.
MeshContent with_normals(MeshContent mesh, std::vector<MeshVertex> normals, Storage& storage) {
  for (MeshVertex const& n : normals)
    for (float const x : {n.x, n.y, n.z}) {
      mesh.digest[0] = (mesh.digest[0] ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ull;
      mesh.digest[0] ^= mesh.digest[0] >> 32;
      mesh.digest[1] = (mesh.digest[1] + std::bit_cast<std::uint32_t>(x)) * 0xbf58476d1ce4e5b9ull;
      mesh.digest[1] ^= mesh.digest[1] >> 29;
    }
  mesh.normals = storage.keep_large(std::move(normals));
  return mesh;
}

}  // namespace

MeshContent smoothed(MeshContent mesh, double angle, Storage& storage) {
  Corners const corners(mesh);
  std::vector<Vec3> facets(mesh.triangles.size);
  for (std::size_t t = 0; t < facets.size(); ++t) facets[t] = facet(mesh, t);
  double const least = std::cos(angle) - 1e-12;
  std::vector<MeshVertex> normals(3 * facets.size());
  for (std::size_t t = 0; t < facets.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      std::uint32_t const vertex = mesh.triangles[t].corner[i];
      Vec3 sum;
      for (std::uint32_t k = corners.first[vertex]; k < corners.first[vertex + 1]; ++k) {
        std::size_t const other = corners.list[k] / 3;
        if (dot(facets[t], facets[other]) < least) continue;
        sum = sum + angle_at(mesh, other, int(corners.list[k] % 3)) * facets[other];
      }
      normals[3 * t + std::size_t(i)] = rounded(length2(sum) > 0 ? unit(sum) : facets[t]);
    }
  return with_normals(mesh, std::move(normals), storage);
}

MeshContent smoothed(MeshContent mesh, std::vector<MeshVertex> normals, Storage& storage) {
  if (normals.size() != 3 * mesh.triangles.size) throw std::invalid_argument("three normals per triangle are needed");
  for (std::size_t k = 0; k < normals.size(); ++k) {
    Vec3 const given = exact(normals[k]), flat = facet(mesh, k / 3);
    double const up = dot(given, flat);
    normals[k] = rounded(std::fabs(up) > 1e-3 * length(given) ? unit(up > 0 ? given : -given) : flat);
  }
  return with_normals(mesh, std::move(normals), storage);
}

}  // namespace straytrace::geometry
