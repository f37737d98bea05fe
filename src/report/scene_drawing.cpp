// SPDX-License-Identifier: BSD-3-Clause
#include "report/scene_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <meshoptimizer.h>
#include <tuple>

#include "geometry/drawing.hpp"

namespace straytrace::report {
namespace {

// Same numbers: same mesh. Shapes at different places along one axis differ by rounding.
using MeshKey = std::vector<long long>;

MeshKey key_of(DrawnMesh const& mesh, std::uint32_t kind) {
  float size = 0;
  for (float const x : mesh.points) size = std::max(size, std::fabs(x));
  double const step = 1e-6 * std::max(size, 1e-9f);
  MeshKey key = {kind, std::llround(1e9 * size), (long long)(mesh.corners.size())};
  for (float const x : mesh.points) key.push_back(std::llround(x / step));
  return key;
}

// Meshes are not compared corner by corner: content and attitude name them.
MeshKey key_of(TriangleMesh const& s, std::uint32_t kind) {
  MeshKey key = {kind, (long long)(s.content.digest[0]), (long long)(s.content.digest[1]), std::llround(1e12 * s.unit)};
  for (Vec3 const& e : {s.pose.e1, s.pose.e2, s.pose.e3})
    for (double const x : {e.x, e.y, e.z}) key.push_back(std::llround(1e9 * x));
  return key;
}

DrawnMesh mesh_of(Drawing const& d, Vec3 place) {
  DrawnMesh mesh;
  for (Vec3 const& p : d.points)
    for (double const x : {p.x - place.x, p.y - place.y, p.z - place.z}) mesh.points.push_back(float(x));
  for (auto const& t : d.triangles) mesh.corners.insert(mesh.corners.end(), t.begin(), t.end());
  mesh.of_triangles = d.triangles.size();
  return mesh;
}

// Corners at one place become one; then edges are collapsed until the mesh is small enough.
void thin_out(DrawnMesh& mesh, std::size_t most) {
  std::size_t const corners = mesh.corners.size(), stride = 3 * sizeof(float);
  std::vector<std::uint32_t> same(mesh.points.size() / 3);
  std::size_t const left =
      meshopt_generateVertexRemap(same.data(), mesh.corners.data(), corners, mesh.points.data(), same.size(), stride);
  std::vector<float> points(3 * left);
  meshopt_remapVertexBuffer(points.data(), mesh.points.data(), same.size(), stride, same.data());
  std::vector<std::uint32_t> all(corners), some(corners);
  meshopt_remapIndexBuffer(all.data(), mesh.corners.data(), corners, same.data());
  float error = 0;
  std::size_t got =
      meshopt_simplify(some.data(), all.data(), corners, points.data(), left, stride, 3 * most, 0.1f, 0, &error);
  if (got > 6 * most)  // its topology holds it together
    got = meshopt_simplifySloppy(some.data(), all.data(), corners, points.data(), left, stride, 3 * most, 1.f, &error);
  some.resize(got);
  mesh.moved = error * meshopt_simplifyScale(points.data(), left, stride);
  mesh.points.resize(3 * left);
  std::size_t const kept =
      meshopt_optimizeVertexFetch(mesh.points.data(), some.data(), got, points.data(), left, stride);
  mesh.points.resize(3 * kept);
  mesh.corners = std::move(some);
}

void thin_out(SceneDrawing& scene, std::size_t most) {
  std::size_t sum = 0;
  for (DrawnMesh const& m : scene.meshes) sum += m.triangles();
  if (sum <= most) return;
  constexpr std::size_t small = 2000;  // triangles: left alone
  for (DrawnMesh& m : scene.meshes)
    if (m.triangles() > small)
      thin_out(m, std::max(small, std::size_t(double(m.triangles()) / double(sum) * double(most))));
}

std::string material_of(World const& world, std::uint32_t optic) {
  for (MaterialInfo const& m : world.materials)
    if (m.optic == optic) return m.name;
  return "";
}

class Collector {
 public:
  explicit Collector(World const& world) : world_(world), view_(world.view()) {}
  void add(std::uint32_t id) {
    Surface const& s = world_.surfaces()[id];
    view_.shapes.visit(s.shape, [&](auto const& shape) { add(s, shape); });
  }
  SceneDrawing scene;

 private:
  template <class Shape>
  void add(Surface const& s, Shape const& shape) {
    scene.box.add(shape.bounds());
    std::uint32_t const mesh = mesh_number(s, shape);
    auto const key = std::tuple(s.group.value, s.body.value, s.front, s.back, mesh, s.clear);
    auto const [at, added] = parts_.emplace(key, scene.parts.size());
    if (added)
      scene.parts.push_back({world_.groups()[s.group.value],
                             s.body.valid() ? world_.bodies()[s.body.value].name : "",
                             material_of(world_, s.front),
                             material_of(world_, s.back),
                             Shape::key,
                             mesh,
                             {},
                             s.clear});
    scene.parts[at->second].places.push_back(shape.reference());
  }
  template <class Shape>
  std::uint32_t mesh_number(Surface const& s, Shape const& shape) {
    if constexpr (std::is_same_v<Shape, TriangleMesh>) {
      auto const [at, added] = meshes_.emplace(key_of(shape, s.shape.kind), std::uint32_t(scene.meshes.size()));
      if (added) scene.meshes.push_back(mesh_of(drawing_of(shape), shape.reference()));
      return at->second;
    } else {
      DrawnMesh mesh = mesh_of(drawing_of(shape), shape.reference());
      auto const [at, added] = meshes_.emplace(key_of(mesh, s.shape.kind), std::uint32_t(scene.meshes.size()));
      if (added) scene.meshes.push_back(std::move(mesh));
      return at->second;
    }
  }
  World const& world_;
  WorldView const view_;
  std::map<MeshKey, std::uint32_t> meshes_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, bool>, std::size_t>
      parts_;
};

}  // namespace

std::size_t SceneDrawing::triangles() const {
  std::size_t sum = 0;
  for (DrawnPart const& p : parts) sum += p.places.size() * meshes[p.mesh].triangles();
  return sum;
}

std::size_t SceneDrawing::of_triangles() const {
  std::size_t sum = 0;
  for (DrawnPart const& p : parts) sum += p.places.size() * meshes[p.mesh].of_triangles;
  return sum;
}

SceneDrawing scene_drawing(World const& world, std::size_t most_triangles) {
  Collector collector(world);
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) collector.add(id);
  thin_out(collector.scene, most_triangles);
  return std::move(collector.scene);
}

}  // namespace straytrace::report
