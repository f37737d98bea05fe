// SPDX-License-Identifier: BSD-3-Clause
// How light rejoins a mode: the walk hits a lit surface (eq. 1.7), a connection reaches a point drawn on it (eq. 1.8),
// or light scatters once at the source (eq. 1.4). The first two sample the same paths and are combined by the power
// heuristic (eq. 1.9), with paths from both ends where there are some (eq. 1.18). A score is the speckle average of
// ORDERED paths; C_rev is applied later (eq. 1.5). Receivers that count watts: receive.hpp.
#pragma once

#include "trace/step/goal.hpp"

namespace straytrace::trace {

template <class Sink>
STRAY_HD void arrive_at(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t index,
                        Sink& sink) {
  Footprint const& lit = world.lit[index];
  double const density = connection_density(lit, vertex.point, vertex.normal());
  if (!(density > 0)) return;
  double const coupling = path.power * rejoin_bsdf(world, vertex, lit) * accepted(world, lit) * density *
                          mode_share(world, path.polarisation, path.ray.dir, vertex, lit);
  // A specular hop has no density: no connection can sample this path.
  Shares const shares = shares_of_hit(world, path, vertex, index);
  if (!(coupling * shares.weight > 0) || !lights(world, lit, vertex.point, vertex.normal())) return;
  tell_shares(sink, shares);
  sink.score(path, vertex, index, arrival_number(index), vertex, coupling * shares.weight);
}

// Several beams may light one surface: the light rejoins each of them.
template <class Sink>
STRAY_HD void score_hit(WorldView const& world, PathState const& path, Vertex const& vertex, Sink& sink) {
  std::uint32_t const first = world.lit_of_surface[vertex.surface.value];
  if (first == WorldView::none) return;
  for (std::uint32_t i = first; i < world.lit.size; ++i)
    if (world.lit[i].receives && world.lit[i].surface == vertex.surface && !returns_to_halo(path, i))
      arrive_at(world, path, vertex, i, sink);
}

// One connection from the vertex to a point of one lit surface, made with this probability.
template <class Sink>
STRAY_HD void connect_to(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t index,
                         SurfaceSpot const& spot, double probability, Sink& sink) {
  Footprint const& lit = world.lit[index];
  Way const way = way_to(world, vertex, spot.at.point);
  if (!(way.bsdf > 0)) return;
  Vertex y = vertex_on(world, spot, way.out);
  if (!(y.wi.z > 0)) return;
  if (dot(y.normal(), lit.travel) >= 0) {  // lit from the other side
    if (!scatters_through(*y.optic)) return;
    y.n_in = way.wo.z < 0 ? vertex.n_out : vertex.n_in;
    y.n_out = lit.index;
  }
  if (blocked(world, vertex, way, y)) return;
  double coupling = path.power / probability * way.bsdf * way.kept * way.geometry(y.cosine()) *
                    rejoin_bsdf(world, y, lit) * accepted(world, lit);  // |u|^2 cos over the density of y is 1
  if (world.polarised)
    coupling *=
        mode_share(world, scattered(path.polarisation, path.ray.dir, way.out, way.wo.z < 0, vertex.optic->depolarise),
                   way.out, y, lit);
  if (!(coupling > 0)) return;
  Shares shares;
  if (lit.profile != Profile::point && !world.surfaces[lit.surface.value].clear)  // which a walk can hit
    shares = shares_of_connection(world, path, vertex, way, y,
                                  walk_density(world, path, vertex, way, y.patch, y.cosine()), index);
  tell_shares(sink, shares);
  sink.score(path, vertex, index, connection_number(index), y, coupling * shares.weight);
}

template <class Sink>
STRAY_HD void connect(WorldView const& world, std::uint64_t seed, PathState const& path, Vertex const& vertex,
                      GoalPoints& points, Sink& sink) {
  if (!(vertex.albedo > 0) || !hears(sink, path)) return;
  for (std::uint32_t i = 0; i < world.lit.size; ++i) {
    bool const counted = path.from_halo && first_of_mirror(path, path.order, i);  // by the classes `halo`
    if (!world.lit[i].receives || counted) continue;
    double const probability = connection_probability(world, vertex.side(), i);
    if (probability < 1 && !(Rng(seed, path.history, path.event, Stream::choice).uniform() < probability)) continue;
    if (SurfaceSpot const* const spot = points.of(world, seed, path, i))
      connect_to(world, path, vertex, i, *spot, probability, sink);
  }
}

// One vertex, same mode in and out: f = q^2 beta cos lambda^2 |u|^2 averaged over the spot (eq. 1.4). The specular
// return of a standing wave is the main mode itself, so cavities have no such term.
template <class Sink>
STRAY_HD void score_single(WorldView const& world, PathState const& path, Vertex const& vertex, Footprint const& lit,
                           Sink& sink) {
  if (!lit.receives || !lit.port.valid()) return;
  double const coupling = path.power * rejoin_bsdf(world, vertex, lit) * accepted(world, lit) *
                          connection_density(lit, vertex.point, vertex.normal()) *
                          mode_share(world, path.polarisation, path.ray.dir, vertex, lit);
  if (coupling > 0) sink.score(path, vertex, path.source, arrival_number(path.source), vertex, coupling);
}

}  // namespace straytrace::trace
