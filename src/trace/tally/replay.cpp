// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/replay.hpp"

#include <algorithm>

#include "trace/tally/route.hpp"

namespace straytrace {
namespace {

// Siblings are followed depth first, so the vertices before the one that a path stands on are always its own.
class ReplaySink {
 public:
  ReplaySink(World const& world, WorldView const& view, std::uint32_t event, std::uint32_t connection)
      : world_(world), view_(view), event_(event), connection_(connection) {}

  void emitted(PathState const& path, Vertex const& vertex) {
    passed_ = {{vertex.surface, vertex.point, view_.lit[path.source].direction(vertex.point), {}, Event::emit}};
    length_ = {0};
  }
  void visit(PathState const& path, Vertex const& vertex) {
    passed_.resize(path.order);
    length_.resize(path.order);
    leave_towards(passed_, vertex.point, path.hop.left_by);
    length_.push_back(length_.back() + vertex.leg);
    passed_.push_back({vertex.surface, vertex.point, passed_.back().out, {}, Event::scatter});
  }
  void score(PathState const& path, Vertex const& vertex, std::uint32_t lit, std::uint32_t connection, Vertex const& y,
             double coupling) {
    if (found || path.event != event_ || connection != connection_) return;
    auto vertices = passed_;
    double path_length = length_.back();
    if (!by_itself(connection)) {
      leave_towards(vertices, y.point, Event::scatter);
      path_length += length(y.point - vertex.point);
      vertices.push_back({y.surface, y.point, vertices.back().out, {}, Event::couple});
    }
    vertices.back().event = Event::couple;
    vertices.back().out = -view_.lit[lit].direction(vertices.back().point);
    bool const other = route_of(view_, path, vertex, lit, connection).other;
    found = ReplayedPath{
        vertices, path.source, lit, other, coupling, path_length, levers_of(world_, vertices, path.source, lit)};
  }
  void book(Fate, double) {}

  std::optional<ReplayedPath> found;

 private:
  static void leave_towards(std::vector<PassedVertex>& vertices, Vec3 point, Event event) {
    PassedVertex& last = vertices.back();
    last.out = unit(point - last.point);
    if (last.event != Event::emit) last.event = event;
  }

  World const& world_;
  WorldView const& view_;
  std::uint32_t event_, connection_;
  std::vector<PassedVertex> passed_;
  std::vector<double> length_;  // m, from the source to each vertex
};

}  // namespace

std::vector<Lever> levers_of(World const& world, std::vector<PassedVertex> const& vertices, std::uint32_t source,
                             std::uint32_t lit) {
  double const k = 2 * pi / world.wavelength;
  std::vector<Lever> levers;
  auto const add = [&](SurfaceId surface, Vec3 point, Vec3 kappa) {  // kappa: rad/m
    BodyId const body = world.surfaces()[surface.value].body;
    auto at = std::find_if(levers.begin(), levers.end(), [&](Lever const& l) { return l.body == body; });
    if (at == levers.end()) at = levers.insert(levers.end(), Lever{body, {}});
    Vec3 const turn = cross(point - world.bodies()[body.value].pivot, kappa);
    double const add_up[6] = {kappa.x, kappa.y, kappa.z, turn.x, turn.y, turn.z};
    for (int i = 0; i < 6; ++i) at->d[i] += add_up[i];
  };
  for (PassedVertex const& v : vertices) add(v.surface, v.point, k * (v.in - v.out));
  // The main mode itself bounces on the mirrors of a cavity: only what differs from it counts (eq. 2.5).
  auto const subtract_main = [&](Footprint const& f) {
    if (f.standing) add(f.surface, f.centre, -2 * k * f.travel);
  };
  subtract_main(world.footprints()[source]);
  if (lit != source) subtract_main(world.footprints()[lit]);
  std::sort(levers.begin(), levers.end(), [](Lever const& a, Lever const& b) { return a.body < b.body; });
  return levers;
}

std::optional<ReplayedPath> replay(World const& world, std::uint64_t seed, std::uint64_t history, std::uint32_t event,
                                   std::uint32_t connection) {
  WorldView const view = world.view();
  ReplaySink sink(world, view, event, connection);
  History again;
  if (!emit(view, seed, history, again.path, sink)) return sink.found;
  do {
    while (!sink.found && step(view, seed, again, sink)) {
    }
  } while (!sink.found && again.next_sibling());
  return sink.found;
}

}  // namespace straytrace
