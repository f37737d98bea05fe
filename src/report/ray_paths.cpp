// SPDX-License-Identifier: BSD-3-Clause
#include "report/ray_paths.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace straytrace::report
