// SPDX-License-Identifier: BSD-3-Clause
// Light counted in watts: hits of the walk on receivers and connections to points drawn on them, combined by the
// balance heuristic as for modes (docs/theory/sampling.md). A score is power relative to the main mode.
#pragma once

#include "trace/step/connect.hpp"

namespace straytrace::trace {

STRAY_HD std::uint32_t goal_of_receiver(WorldView const& world, std::uint32_t receiver) {
  return std::uint32_t(world.lit.size) + receiver;
}

// Density of a point drawn evenly on a surface, 1/m^2.
STRAY_HD double area_density(WorldView const& world, SurfaceId id) {
  return 1 / world.shapes.visit(world.surfaces[id.value].shape, [](auto const& s) { return s.area(); });
}
// Density per area with which a connection draws its point.
STRAY_HD double receiver_density(WorldView const& world, Receiver const& r) { return area_density(world, r.surface); }

// Density with which sub-paths (sub_path.hpp) start along `out`, per area and projected solid angle,
// 1/(m^2 sr): by the cosine law on the sides that count, or towards a point drawn uniformly on one of the aims,
// hidden or not. `cosine`: at the receiver.
STRAY_HD double start_density(WorldView const& world, Receiver const& r, Ray const& out, double cosine) {
  double density = 1 / (pi * r.sides());
  if (r.aims > 0) {
    double towards = 0;
    for (std::uint32_t i = 0; i < r.aims; ++i) {
      Crossing const met = world.cross(r.aim[i].value, out, {});
      if (!(met.distance < infinity)) continue;
      Vec3 const normal = world.normal(r.aim[i], out.origin + met.distance * out.dir, met.piece);
      towards += per_solid_angle(area_density(world, r.aim[i]), met.distance, std::fabs(dot(normal, out.dir)));
    }
    density = (1 - Receiver::aimed_share) * density + Receiver::aimed_share * towards / (r.aims * cosine);
  }
  return receiver_density(world, r) * density;
}

// The receiver as the first link of a path whose light arrives along `travel` at y.
STRAY_HD Ends ends_on(WorldView const& world, Receiver const& r, Vertex const& y, Vec3 travel) {
  Ends ends;
  ends.area = receiver_density(world, r);
  ends.sub_paths = r.clear ? 0 : r.sub_paths;
  if (ends.sub_paths > 0) ends.link[0].backward = start_density(world, r, {y.point, -travel}, y.cosine()) / ends.area;
  return ends;
}

STRAY_HD Shares shares_of_hit(WorldView const& world, PathState const& path, Vertex const& y, Receiver const& r) {
  double const walk = per_area(path.hop.pdf, y.leg, y.cosine());
  if (!(r.sub_paths > 0) || r.clear) return {path.hop.pdf > 0 ? walk / (walk + receiver_density(world, r)) : 1, 1};
  if (path.trail.count == 0) return {1, 1};
  Ends ends = ends_on(world, r, y, path.ray.dir);
  ends.append(path.trail, 1);
  ends.start = path.trail.start;
  ends.link[0].backward *= path.trail.back;
  ends.link[0].geometry = arrival_geometry(path.hop, y);
  return ends.shares(0);
}

template <class Sink>
STRAY_HD void receive_at(WorldView const& world, PathState const& path, Vertex const& y, std::uint32_t receiver,
                         double power, Sink& sink) {
  Receiver const& r = world.receivers[receiver];
  if (!r.counts(y.front) || !(power > 0)) return;
  std::uint32_t const goal = goal_of_receiver(world, receiver);
  Shares const shares = shares_of_hit(world, path, y, r);
  tell_shares(sink, shares);
  sink.score(path, y, goal, arrival_number(goal), y, power * shares.own);
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

// n^2 cos cos'/d^2 of a line from a vertex to a point that it meets under `cosine` (eq. 1.16).
STRAY_HD double line_geometry(Vertex const& from, Way const& way, double cosine) {
  double const n = way.wo.z < 0 ? from.n_out : from.n_in;
  double const leaving = from.smooth ? std::fabs(dot(way.out, from.facet)) : std::fabs(way.wo.z);
  return n * n * leaving * cosine / (way.length * way.length);
}

// The vertex x of the walk and those before it, behind the first `t` of `ends`, for light that leaves x along `way`.
// `walk`: density per area with which the walk goes that way.
STRAY_HD void append_walk(WorldView const& world, PathState const& path, Vertex const& x, Way const& way, double cosine,
                          double walk, std::uint32_t t, Ends& ends) {
  double const geometry = line_geometry(x, way, cosine);
  ends.link[t - 1].geometry = geometry;
  ends.link[t] = link_at(world, path.trail, path.hop, x, path.ray.dir, way.out, way.wo.z < 0);
  ends.link[t].forward = walk / geometry;
  ends.append(path.trail, t + 1);
  ends.start = start_of(world, path, x, path.hop);
}

STRAY_HD Shares shares_of_connection(WorldView const& world, PathState const& path, Vertex const& vertex,
                                     Way const& way, Vertex const& y, double walk, Receiver const& r) {
  double const density = receiver_density(world, r);
  if (!(r.sub_paths > 0) || r.clear) return {density / (density + walk), 1};
  Ends ends = ends_on(world, r, y, way.out);
  append_walk(world, path, vertex, way, y.cosine(), walk, 1, ends);
  return ends.shares(1);
}

// Connection to a point drawn evenly on the receiver.
template <class Sink>
STRAY_HD void connect_to_receiver(WorldView const& world, PathState const& path, Vertex const& vertex,
                                  std::uint32_t receiver, double u, double v, Sink& sink) {
  Receiver const& r = world.receivers[receiver];
  SurfacePoint const drawn =
      world.shapes.visit(world.surfaces[r.surface.value].shape, [&](auto const& s) { return sample_of(s, u, v); });
  Way const way = way_to(world, vertex, drawn.point);
  if (!(way.bsdf > 0)) return;
  Vertex const y = make_vertex(world, r.surface, drawn.point, way.out, drawn.piece);
  if (!(y.wi.z > 0) || !r.counts(y.front)) return;
  if (!r.clear && blocked(world, vertex, way, y)) return;
  double const walk =
      r.clear ? walk_past(world, path, vertex, way, y) : walk_density(world, path, vertex, way, y.patch, y.cosine());
  if (walk < 0) return;
  Shares const shares = shares_of_connection(world, path, vertex, way, y, walk, r);
  double const power =
      path.power * way.bsdf * way.kept * way.geometry(y.cosine()) * shares.own / receiver_density(world, r);
  std::uint32_t const goal = goal_of_receiver(world, receiver);
  if (!(power > 0)) return;
  tell_shares(sink, shares);
  sink.score(path, vertex, goal, connection_number(goal), y, power);
}

template <class Sink>
STRAY_HD void connect_receivers(WorldView const& world, std::uint64_t seed, PathState const& path, Vertex const& vertex,
                                Sink& sink) {
  if (world.receivers.size == 0 || !(vertex.albedo > 0) || !hears(sink, path)) return;
  Rng rng(seed, path.history, path.event, Stream::receiver);
  for (std::uint32_t i = 0; i < world.receivers.size; ++i) {
    double const u = rng.uniform(), v = rng.uniform();
    connect_to_receiver(world, path, vertex, i, u, v, sink);
  }
}

}  // namespace straytrace::trace
