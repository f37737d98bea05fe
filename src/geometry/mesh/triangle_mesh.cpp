// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/mesh/triangle_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "geometry/drawing.hpp"

namespace straytrace::geometry {
namespace {

// Walker's alias table: row i covers 1/n of the whole, shared by i and one other.
std::vector<AliasRow> alias_table(std::vector<double> const& weights, double total) {
  std::size_t const n = weights.size();
  std::vector<AliasRow> rows(n);
  std::vector<double> share(n);
  std::vector<std::uint32_t> poor, rich;
  for (std::size_t i = 0; i < n; ++i) {
    share[i] = total > 0 ? weights[i] / total * double(n) : 1;
    (share[i] < 1 ? poor : rich).push_back(std::uint32_t(i));
  }
  while (!poor.empty() && !rich.empty()) {
    std::uint32_t const small = poor.back(), large = rich.back();
    poor.pop_back();
    rows[small] = {share[small], large};
    share[large] -= 1 - share[small];
    if (share[large] < 1) {
      rich.pop_back();
      poor.push_back(large);
    }
  }
  for (std::uint32_t i : rich) rows[i] = {1, i};
  for (std::uint32_t i : poor) rows[i] = {1, i};  // rounding: no partner remains
  return rows;
}

double distance_to_segment(double ax, double ay, double bx, double by) {  // of the origin of a plane
  double const dx = bx - ax, dy = by - ay, d2 = dx * dx + dy * dy;
  double const s = d2 > 0 ? std::clamp(-(ax * dx + ay * dy) / d2, 0.0, 1.0) : 0;
  return std::hypot(ax + s * dx, ay + s * dy);
}

// Smallest distance of a triangle from the z axis, a little less than it is.
double distance_to_axis(Vec3 a, Vec3 b, Vec3 c) {
  auto const turn = [](Vec3 p, Vec3 q) { return p.x * q.y - p.y * q.x; };
  double const u = turn(a, b), v = turn(b, c), w = turn(c, a);
  if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) return 0;
  return (1 - 1e-12) * std::min({distance_to_segment(a.x, a.y, b.x, b.y), distance_to_segment(b.x, b.y, c.x, c.y),
                                 distance_to_segment(c.x, c.y, a.x, a.y)});
}

// Fills packs leaf by leaf and makes the leaves of the tree name packs instead of boxes.
std::vector<TrianglePack> packed(Bvh8& tree, std::vector<MeshVertex> const& vertices,
                                 std::vector<MeshTriangle> const& triangles) {
  std::vector<TrianglePack> packs;
  tree.rename_leaves([&](std::uint32_t first, std::uint32_t count) {
    TrianglePack& pack = packs.emplace_back();
    for (std::uint32_t i = 0; i < 8; ++i) {
      std::uint32_t const id = tree.order[first + std::min(i, count - 1)];
      pack.triangle[i] = id;
      for (int k = 0; k < 3; ++k) {
        MeshVertex const v = vertices[triangles[id].corner[k]];
        pack.corner[k][0][i] = v.x;
        pack.corner[k][1][i] = v.y;
        pack.corner[k][2][i] = v.z;
      }
    }
    return std::uint32_t(packs.size() - 1);
  });
  return packs;
}

void measure(MeshContent& mesh, std::vector<MeshVertex> const& vertices, std::vector<MeshTriangle> const& triangles,
             std::vector<Box>& boxes, std::vector<double>& areas) {
  mesh.near = infinity;
  for (MeshTriangle const& t : triangles) {
    Box box;
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k) {
      if (t.corner[k] >= vertices.size()) throw std::out_of_range("a triangle refers to a vertex that does not exist");
      corner[k] = exact(vertices[t.corner[k]]);
      box.add(corner[k]);
      mesh.far = std::max(mesh.far, (1 + 1e-12) * std::hypot(corner[k].x, corner[k].y));
    }
    mesh.near = std::min(mesh.near, distance_to_axis(corner[0], corner[1], corner[2]));
    mesh.box.add(box);
    boxes.push_back(box);
    areas.push_back(0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0])));
    mesh.area += areas.back();
    double const ab = length(corner[1] - corner[0]), ac = length(corner[2] - corner[0]);
    mesh.close = std::max(mesh.close, LeavingRule::reach(ab, ac));
  }
  double const pad = 1e-12 * std::max({std::fabs(mesh.box.lower.z), std::fabs(mesh.box.upper.z), mesh.far});
  mesh.low = mesh.box.lower.z - pad;
  mesh.high = mesh.box.upper.z + pad;
}

// Two sums of different mixers over all numbers, in order.
void digest(MeshContent& mesh, std::vector<MeshVertex> const& vertices, std::vector<MeshTriangle> const& triangles) {
  std::uint64_t a = vertices.size(), b = triangles.size();
  auto const add = [&](std::uint64_t x) {
    a = (a ^ x) * 0x9e3779b97f4a7c15ull;
    a ^= a >> 32;
    b = (b + x) * 0xbf58476d1ce4e5b9ull;
    b ^= b >> 29;
  };
  for (MeshVertex const& v : vertices)
    for (float x : {v.x, v.y, v.z}) add(std::bit_cast<std::uint32_t>(x));
  for (MeshTriangle const& t : triangles)
    for (std::uint32_t corner : t.corner) add(corner);
  mesh.digest[0] = a;
  mesh.digest[1] = b;
}

void list_in_order(MeshContent& mesh, Bvh8 const& tree, std::vector<double> const& areas, Storage& storage) {
  std::vector<std::uint32_t> place(areas.size());
  std::vector<double> before{0};
  before.reserve(areas.size() + 1);
  for (std::uint32_t i = 0; i < tree.order.size(); ++i) {
    place[tree.order[i]] = i;
    before.push_back(before.back() + areas[tree.order[i]]);
  }
  mesh.in_order = storage.keep(tree.order);
  mesh.place = storage.keep(std::move(place));
  mesh.area_before = storage.keep(std::move(before));
}

#if STRAY_VECTORS && defined(__x86_64__)
// One source for three instruction sets; every lane does the same IEEE operations, so the bits agree.
__attribute__((target("avx512f,avx512vl,avx512dq,bmi"))) Crossing crossing_512(TriangleMesh const& mesh, Ray const& ray,
                                                                               std::uint32_t leaving) {
  return mesh.crossing_with<8>(ray, leaving);
}
__attribute__((target("avx2,bmi"))) Crossing crossing_256(TriangleMesh const& mesh, Ray const& ray,
                                                          std::uint32_t leaving) {
  return mesh.crossing_with<4>(ray, leaving);
}
#endif
Crossing crossing_128(TriangleMesh const& mesh, Ray const& ray, std::uint32_t leaving) {
  return mesh.crossing_with<2>(ray, leaving);
}

using Version = Crossing (*)(TriangleMesh const&, Ray const&, std::uint32_t);
// The fastest that this processor can run and the environment variable STRAYTRACE_ISA allows.
Version version_for_this_processor() {
#if STRAY_VECTORS && defined(__x86_64__)
  char const* const named = std::getenv("STRAYTRACE_ISA");
  std::string_view const wanted = named ? named : "avx512";
  if (wanted == "portable") return crossing_128;
  if (wanted != "avx2" && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("bmi"))
    return crossing_512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi")) return crossing_256;
#endif
  return crossing_128;
}

}  // namespace

#if STRAY_VECTORS
Crossing TriangleMesh::crossing(Ray const& ray, std::uint32_t leaving) const {
  static Version const version = version_for_this_processor();
  return version(*this, ray, leaving);
}
#endif

MeshContent prepare_mesh(std::vector<MeshVertex> vertices, std::vector<MeshTriangle> triangles, Storage& storage) {
  MeshContent mesh;
  std::vector<Box> boxes;
  std::vector<double> areas;
  boxes.reserve(triangles.size());
  areas.reserve(triangles.size());
  measure(mesh, vertices, triangles, boxes, areas);
  digest(mesh, vertices, triangles);
  Bvh8Settings settings;
  settings.leaf_size = 8;
  settings.pack = 8;
  settings.traversal_cost = 4;  // half of a pack
  Bvh8 tree = build_bvh8(boxes, settings);
  mesh.packs = storage.keep_large(packed(tree, vertices, triangles));
  list_in_order(mesh, tree, areas, storage);
  mesh.by_area = storage.keep(alias_table(areas, mesh.area));
  mesh.tree = tree.view();
  mesh.tree.nodes = storage.keep_large(std::move(tree.nodes));
  mesh.vertices = storage.keep_large(std::move(vertices));
  mesh.triangles = storage.keep_large(std::move(triangles));
  return mesh;
}

Drawing TriangleMesh::drawing() const {
  Drawing d;
  for (std::size_t i = 0; i < content.vertices.size; ++i)
    d.points.push_back(pose.point(unit * exact(content.vertices[i])));
  for (std::size_t i = 0; i < content.triangles.size; ++i) {
    auto const& corner = content.triangles[i].corner;
    d.triangles.push_back({corner[0], corner[1], corner[2]});
  }
  return d;
}

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
