// SPDX-License-Identifier: BSD-3-Clause
// Light counted in watts: hits of the walk on receivers and connections to points drawn on them, combined by the
// power heuristic (docs/theory/sampling.md, eq. 1.18). A score is power relative to the main mode.
#pragma once

#include "trace/step/goal.hpp"

namespace straytrace::trace {

template <class Sink>
STRAY_HD void receive_at(WorldView const& world, PathState const& path, Vertex const& y, std::uint32_t receiver,
                         double power, Sink& sink) {
  Receiver const& r = world.receivers[receiver];
  if (!r.counts(y.front) || !(power > 0)) return;
  std::uint32_t const goal = goal_of_receiver(world, receiver);
  Shares const shares = shares_of_hit(world, path, y, goal);
  tell_shares(sink, shares);
  sink.score(path, y, goal, arrival_number(goal), y, power * shares.weight);
}

// Light that hits a receiver: its surface, or a measuring plane that the leg crosses.
template <class Sink>
STRAY_HD void receive(WorldView const& world, PathState const& path, Vertex const& vertex, Sink& sink) {
  if (world.receivers.size == 0) return;
  std::uint32_t const first = world.receiver_of_surface[vertex.surface.value];
  if (first == WorldView::none) return;
  for (std::uint32_t i = first; i < world.receivers.size; ++i)
    if (world.receivers[i].surface == vertex.surface) receive_at(world, path, vertex, i, path.power, sink);
}
template <class Sink>
STRAY_HD void pass_planes(WorldView const& world, PathState const& path, double to, Sink& sink) {
  for (std::uint32_t i = 0; i < world.receivers.size; ++i) {
    SurfaceId const id = world.receivers[i].surface;
    if (!world.receivers[i].clear) continue;
    Crossing const met = world.cross(id.value, {path.ray.origin, path.ray.dir, to}, {});
    if (!(met.distance < infinity)) continue;
    Vertex y = make_vertex(world, id, path.ray.origin + met.distance * path.ray.dir, path.ray.dir, met.piece);
    y.leg = met.distance;
    receive_at(world, path, y, i, path.power * kept_along(world, path.media, y.leg), sink);
  }
}

// Density per area at the point y of a measuring plane with which the walk would have passed there; it depends on the
// surface behind. Negative: hidden.
STRAY_HD double walk_past(WorldView const& world, PathState const& path, Vertex const& vertex, Way const& way,
                          Vertex const& y) {
  Hit const behind = world.closest({vertex.point, way.out}, {vertex.surface, vertex.piece, vertex.contact});
  if (!behind.surface.valid()) return walk_density(world, path, vertex, way, WorldView::none, y.cosine());
  if (behind.distance < way.length - world.slack(y.surface, way.length, y.cosine())) return -1;
  Vertex const end =
      make_vertex(world, behind.surface, vertex.point + behind.distance * way.out, way.out, behind.piece);
  double const there = walk_density(world, path, vertex, {way.out, way.wo, behind.distance, way.bsdf, way.law_pdf},
                                    end.patch, end.cosine());
  return per_area(per_solid_angle(there, behind.distance, end.cosine()), way.length, y.cosine());
}

// Connection to a point drawn evenly on the receiver.
template <class Sink>
STRAY_HD void connect_to_receiver(WorldView const& world, PathState const& path, Vertex const& vertex,
                                  std::uint32_t receiver, SurfaceSpot const& spot, Sink& sink) {
  Receiver const& r = world.receivers[receiver];
  Way const way = way_to(world, vertex, spot.at.point);
  if (!(way.bsdf > 0)) return;
  Vertex const y = vertex_on(world, spot, way.out);
  if (!(y.wi.z > 0) || !r.counts(y.front)) return;
  if (!r.clear && blocked(world, vertex, way, y)) return;
  double const walk =
      r.clear ? walk_past(world, path, vertex, way, y) : walk_density(world, path, vertex, way, y.patch, y.cosine());
  if (walk < 0) return;
  std::uint32_t const goal = goal_of_receiver(world, receiver);
  Shares const shares = shares_of_connection(world, path, vertex, way, y, walk, goal);
  double const power =
      path.power * way.bsdf * way.kept * way.geometry(y.cosine()) * shares.weight / receiver_density(world, r);
  if (!(power > 0)) return;
  tell_shares(sink, shares);
  sink.score(path, vertex, goal, connection_number(goal), y, power);
}

template <class Sink>
STRAY_HD void connect_receivers(WorldView const& world, std::uint64_t seed, PathState const& path, Vertex const& vertex,
                                GoalPoints& points, Sink& sink) {
  if (world.receivers.size == 0 || !(vertex.albedo > 0) || !hears(sink, path)) return;
  for (std::uint32_t i = 0; i < world.receivers.size; ++i)
    connect_to_receiver(world, path, vertex, i, *points.of(world, seed, path, goal_of_receiver(world, i)), sink);
}

}  // namespace straytrace::trace
