// SPDX-License-Identifier: BSD-3-Clause
#include "report/scene_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <meshoptimizer.h>
#include <tuple>

#include "geometry/drawing.hpp"
#include "trace/camera/first_order.hpp"
#include "trace/step/step.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::report {
namespace {

DrawnPath drawn(World const& world, CouplingClass const& c, PathRecord const& r, ReplayedPath const& path) {
  DrawnPath d{c.hash, r.history, r.event, r.connection, r.weight, path.path_length, c.by_reverse, false, {}};
  for (PassedVertex const& v : path.vertices) {
    BodyId const body = v.surface.valid() ? world.surfaces()[v.surface.value].body : BodyId{};
    d.points.push_back({v.point, v.event, v.group, body, v.surface});
  }
  return d;
}

// Where a ray leaves a box that it starts in or near; its start when it never comes near.
Vec3 leaves(Box const& box, Ray const& ray) {
  double end = 0;
  double const origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z}, dir[3] = {ray.dir.x, ray.dir.y, ray.dir.z};
  double const low[3] = {box.lower.x, box.lower.y, box.lower.z}, high[3] = {box.upper.x, box.upper.y, box.upper.z};
  double nearest = infinity;
  for (int i = 0; i < 3; ++i)
    if (dir[i] != 0) nearest = std::min(nearest, ((dir[i] > 0 ? high[i] : low[i]) - origin[i]) / dir[i]);
  if (std::isfinite(nearest)) end = std::max(nearest, 0.0);
  return ray.origin + end * ray.dir;
}

// Follows one history; calls each(path, hit) before every leg.
template <class Sink, class Each>
void follow(WorldView const& view, std::uint64_t seed, std::uint64_t number, Sink& sink, Each const& each) {
  History history;
  history.begin(number);
  bool goes_on = begin(view, seed, history, sink);
  while (goes_on) {
    Hit const hit = view.closest(history.path.ray, history.path.from);
    each(history.path, hit);
    goes_on = step(view, seed, history, hit, sink) || next_path(view, seed, history, sink);
  }
}

class TellingSink {
 public:
  TellingSink(World const& world, WorldView const& view) : world_(world), view_(view) {}
  void emitted(PathState const& path, Vertex const& v) { add("emit", path, v, path.emitted); }
  void visit(PathState const& path, Vertex const& v) { add("arrive", path, v, path.power); }
  void score(PathState const& path, Vertex const& v, std::uint32_t goal, std::uint32_t, Vertex const& y,
             double coupling) {
    add_score(path, v, goal, coupling);
    if (y.surface.valid()) place(events.back(), y);
  }
  void score_halo(PathState const& path, Vertex const&, Vertex const& y, std::uint32_t source, bool, double coupling) {
    add("rejoin", path, y, coupling);
    PortId const port = view_.lit[view_.halo.sources[source].footprint].port;
    if (port.valid()) events.back().where = world_.ports()[port.value];
  }
  void score_through(PathState const& path, Vertex const& v, Vertex const&, Chain const&, std::uint32_t goal,
                     Vertex const&, double power) {
    add_score(path, v, goal, power);
  }
  void score_lit(PathState const& path, std::uint32_t, Vertex const& z, Chain const&, std::uint32_t goal, Vertex const&,
                 double power) {
    add_score(path, z, goal, power);
  }
  void book(BalanceTerm balance_term, double power) {
    if (power == 0) return;
    HistoryEvent t;
    t.what = name_of(balance_term);
    t.power = power;
    t.point = {not_a_number, not_a_number, not_a_number};
    events.push_back(t);
  }
  std::vector<HistoryEvent> events;

 private:
  void place(HistoryEvent& t, Vertex const& v) const {
    Surface const& s = view_.surfaces[v.surface.value];
    t.where = world_.groups()[s.group.value];
    t.body = s.body.valid() ? world_.bodies()[s.body.value].name : "";
    t.point = v.point;
  }
  void add(char const* what, PathState const& path, Vertex const& v, double power) {
    HistoryEvent t{what, path.event, path.order, "", "", v.point, power};
    if (v.surface.valid()) place(t, v);
    events.push_back(t);
  }
  void add_score(PathState const& path, Vertex const& v, std::uint32_t goal, double power) {
    if (is_receiver(view_, goal)) {
      add("receive", path, v, power);
      events.back().where = world_.receiver_names().at(place_of(view_, goal));
      return;
    }
    add("rejoin", path, v, power);
    PortId const port = view_.lit[goal].port;
    if (port.valid()) events.back().where = world_.ports()[port.value];
  }
  World const& world_;
  WorldView const& view_;
};

}  // namespace

std::vector<DrawnPath> paths_of(SteeredWorld const& world, std::uint64_t seed, CouplingClass const& c,
                                std::size_t most) {
  std::vector<DrawnPath> all;
  double sum = 0, before = 0;
  for (PathRecord const& r : c.records) sum += r.weight;
  if (c.deterministic() || !(sum > 0) || most == 0) return all;
  // Where there are more records than wanted: one for each time that the growing sum passes the middle of a step.
  bool const thin = c.records.size() > most;
  double const step_size = sum / double(most);
  auto const passed = [&] { return std::floor(before / step_size + 0.5); };
  Replay replay(world, seed);
  for (PathRecord const& r : c.records) {
    double const until_here = passed();
    before += r.weight;
    double const times = passed() - until_here;
    if (thin && !(times > 0)) continue;
    auto const path = replay(r.history, r.event, r.connection);
    if (!path) continue;
    all.push_back(drawn(world, c, r, *path));
    if (thin) all.back().weight = times * step_size;
  }
  return all;
}

std::vector<RaySegment> sample_rays(SteeredWorld const& world, Box const& box, std::uint64_t seed,
                                    std::uint64_t histories) {
  std::vector<RaySegment> all;
  WorldView const view = world.view();
  NullSink sink;
  for (std::uint64_t h = 0; h < histories; ++h)
    follow(view, seed, h, sink, [&](PathState const& path, Hit const& hit) {
      bool const met = hit.surface.valid();
      all.push_back({met ? RaySegment::End::met : RaySegment::End::escaped, path.ray.origin,
                     met ? path.ray.origin + hit.distance * path.ray.dir : leaves(box, path.ray), path.power,
                     path.order, met ? view.surfaces[hit.surface.value].group : GroupId{}, h});
    });
  return all;
}

std::vector<HistoryEvent> replay_history_events(SteeredWorld const& world, std::uint64_t seed, std::uint64_t history) {
  WorldView const view = world.view();
  TellingSink sink(world, view);
  follow(view, seed, history, sink, [](PathState const&, Hit const&) {});
  return std::move(sink.events);
}

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
