// SPDX-License-Identifier: BSD-3-Clause
// The simulation: emission, the step (one hop and one vertex of one path), the weight window, and the loop over a
// history (docs/theory/path_integral.md; docs/theory/sampling.md). All other code prepares the world or sums the
// scores.
//
// The only output goes to a Sink:
//   emitted(path, vertex)                     a history starts: power scattered out of the mode by its first vertex
//   visit(path, vertex)                       light has reached a vertex, with path.power
//   score(path, vertex, lit, connection, y, coupling)  light rejoined the mode of footprint `lit` at the point y
//   score_halo(path, x, y, source, connected, coupling)  optional: light rejoined the mode of `source` by a surface in
//                                        its light below the crossover angle, at y; x: the vertex before, or y itself
//   score_through(path, x, z, chain, goal, end, power)   optional: light on a goal by x and a sub-path from z
//   score_lit(path, source, z, chain, goal, end, power)  optional: by a sub-path from z, in the light of a beam
//   book(term, power)                         the energy balance
//   shares(shares)                            optional: of the next score, eq. 1.18
//   hears(event)                              optional: whether scores of this vertex are heard; the walk is the same
//   absorbed(group, power)                    optional: power absorbed by a group; invalid group: by a medium
//   roulette_variance(variance)               optional: of the power just booked under `roulette`
#pragma once

#include "trace/step/connect.hpp"
#include "trace/step/halo_ends.hpp"
#include "trace/step/receive.hpp"
#include "trace/step/scatter.hpp"
#include "trace/step/sub_path.hpp"

namespace straytrace::trace {

// Hears nothing; a base of those that hear little.
struct NullSink {
  template <class... T>
  void emitted(T const&...) {}
  template <class... T>
  void visit(T const&...) {}
  template <class... T>
  void score(T const&...) {}
  void book(BalanceTerm, double) {}
};

// One history: its path and the waiting siblings, depth first.
struct History {
  static constexpr std::uint32_t most_waiting = 16;
  PathState path;
  std::uint32_t events = 0;  // vertices numbered so far
  std::uint32_t waiting = 0;
  PathState sibling[most_waiting];
  PathState parent;  // at the first vertex, for `children` further paths from there
  Vertex parent_vertex;
  std::uint32_t children = 0;  // still to come
  SubPaths sub_paths;
  GoalPoints goal_points;
  STRAY_HD void begin(std::uint64_t number) {
    path = {};
    path.history = number;
    goal_points.begin();
    events = waiting = children = sub_paths.count = 0;
  }
  STRAY_HD std::uint32_t new_event() { return ++events; }
  STRAY_HD bool next_sibling() {
    if (waiting == 0) return false;
    path = sibling[--waiting];
    return true;
  }
};

// A beam that starts in empty space starts on its plane along the local normal of its wavefront.
template <class Sink>
STRAY_HD void emit_free(Footprint const& beam, Ray const& line, PathState& path, Sink& sink) {
  Vertex start;  // on no surface
  start.point = line.origin + beam.backoff * beam.travel;
  path.emitted = path.power;
  path.ray = {start.point, beam.direction(start.point)};
  path.hop.left_by = Event::emit;
  path.coherent = true;
  path.path_length = beam.lag(start.point);
  path.route = extended(path.route, beam.origin, Event::emit);
  sink.emitted(path, start);
}

// Histories of a block are dealt to sources and first targets by systematic sampling (docs/theory/sampling.md): evenly
// spaced numbers in (0, 1) with one random shift per block.
STRAY_HD double stratum(std::uint64_t seed, std::uint64_t history, std::uint64_t block_size) {
  std::uint64_t const place = history % block_size;
  double const shift = Rng(seed, history - place, 0xffffffffu, Stream::source).uniform();
  double const x = (double(place) + shift) / double(block_size);
  return x < 1 ? x : x - 1;
}

// Where a path is: it has ended, is at a vertex that it has to leave, or on its way to the next one.
enum class Where : std::uint8_t { nowhere, at_vertex, in_flight };

// Draws a source, and the first vertex or, from the plane of a free beam, the first ray. The first vertex is a point of
// a lit surface, drawn with the weight |u|^2 of the mode (eq. 1.6), where light is scattered out of the mode. Specular
// reflection of the mode is the mode itself, not stray light.
template <class Sink>
STRAY_HD Where launch(WorldView const& world, std::uint64_t seed, PathState& path, Vertex& vertex, Sink& sink) {
  auto const n = static_cast<std::uint32_t>(world.emitters.size);
  if (n == 0) return Where::nowhere;  // nothing lit scatters
  Rng rng(seed, path.history, 0, Stream::source);
  double const draws = world.draws(), place = stratum(seed, path.history, world.block_size) * draws;
  auto pick = static_cast<std::uint32_t>(place);
  if (pick >= n) pick = n - 1;
  path.stratum = place - pick;
  path.source = world.emitters[pick];
  Footprint const& lit = world.lit[path.source];
  path.polarisation = lit.polarisation;
  path.power = lit.share * draws;
  double u = rng.uniform(), v = rng.uniform();
  path.strata.deal(Dealt::source, u, v);
  Ray const line = lit.sample(u, v);
  Crossing const met = lit.free ? Crossing{} : world.cross(lit.surface.value, line, {});
  if (lit.free) {
    emit_free(lit, line, path, sink);
    return Where::in_flight;
  }
  if (!(met.distance < infinity)) return Where::nowhere;  // outside the clear aperture: clipped, not scattered
  Vec3 const point = line.origin + met.distance * line.dir;
  path.ray.dir = lit.direction(point);
  vertex = make_vertex(world, lit.surface, point, path.ray.dir, met.piece);
  evaluate_scattering(world, path, path.ray.dir, vertex);
  path.emitted = path.power * vertex.albedo;
  if (lit.profile != Profile::point) path.trail.start = connection_density(lit, vertex.point, vertex.normal()) / draws;
  sink.emitted(path, vertex);
  if (!lit.standing && lit.returns) score_single(world, path, vertex, lit, sink);
  return Where::at_vertex;
}
// The first ray of a history, without connections at its source. False: there is none.
template <class Sink>
STRAY_HD bool emit(WorldView const& world, std::uint64_t seed, PathState& path, Sink& sink) {
  path.strata = {seed, path.history, world.block_size};
  Vertex vertex;
  Where const at = launch(world, seed, path, vertex, sink);
  return at == Where::in_flight || (at == Where::at_vertex && scatter(world, seed, path, vertex, sink, true));
}

// The weight window keeps the population of paths constant (docs/theory/sampling.md): bright or important paths are
// split; faint ones survive roulette with their power raised, so the mean is kept. The importance of a path is its
// power times the adjoint.
constexpr double window_width = 5;  // paths within this factor of the target are not changed
constexpr std::uint32_t most_copies = 16;
// A history with more vertices than this, for each order and child, splits no more. Where walls absorb nothing and the
// adjoint varies, a few histories would otherwise do most of the work. The past of a history alone decides, so the mean
// is kept.
constexpr std::uint64_t most_events_per_order = 256;
STRAY_HD bool may_split(WorldView const& world, History const& history) {
  return history.events < most_events_per_order * world.limits.max_order * world.limits.children;
}

// The importance that a path keeps: power x adjoint at its first vertex, so that routes through a rare first target get
// the effort assigned to that target. A scattered path without a target keeps the importance of an average first
// vertex. That average excludes free beams, whose first vertex sets their level. Light below the crossover angle has an
// average of its own.
STRAY_HD double level_of(WorldView const& world, PathState const& path, double adjoint) {
  if (path.from_halo && world.halo.level > 0) return world.halo.level;
  bool const astray = !path.coherent && (path.hop.off_list || !path.hop.aimed);
  return astray ? world.steering.level : path.power * adjoint;
}

// Number of copies that continue, each with path.power; 0: the roulette ends the path. Without an adjoint, plain
// roulette below a share of the power first scattered. That roulette compares power, not power x adjoint, for lack of
// an adjoint: this costs efficiency, never the mean.
template <class Sink>
STRAY_HD std::uint32_t control(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex,
                               std::uint32_t room, Sink& sink) {
  std::uint32_t const side = vertex.side();
  double const adjoint =
      side == WorldView::none || !(world.steering.level > 0) ? 0 : world.steering.sides[side].adjoint;
  if (adjoint > 0 && path.level == 0) path.level = level_of(world, path, adjoint);
  double target = adjoint > 0 ? path.level / adjoint : world.limits.roulette_below * path.emitted;
  if (target > path.emitted) target = path.emitted;  // no path carries more than its history emitted
  double const lowest = adjoint > 0 ? target / window_width : target;
  if (path.power < lowest) {
    bool const lucky = Rng(seed, path.history, path.event, Stream::window).uniform() * target < path.power;
    double const after = lucky ? target : 0;
    sink.book(BalanceTerm::roulette, path.power - after);
    if constexpr (requires { sink.roulette_variance(0.0); }) sink.roulette_variance(path.power * (target - path.power));
    path.power = after;
    return lucky ? 1 : 0;
  }
  if (!(adjoint > 0) || path.power <= window_width * target) return 1;
  std::uint32_t const most = room + 1 < most_copies ? room + 1 : most_copies;
  double const wanted = std::floor(path.power / target);
  std::uint32_t const copies = wanted < most ? static_cast<std::uint32_t>(wanted) : most;
  path.power /= copies;
  return copies;
}

// Children share the power equally; those not followed yet wait with their parent.
STRAY_HD void have_children(History& history, Vertex const& vertex, std::uint32_t children) {
  history.path.power /= children;
  history.parent = history.path;
  history.parent_vertex = vertex;
  history.children = children - 1;
}
// Starts the next path of this history; false: there is none.
template <class Sink>
STRAY_HD bool next_path(WorldView const& world, std::uint64_t seed, History& history, Sink& sink) {
  if (history.next_sibling()) return true;
  while (history.children > 0) {
    --history.children;
    history.path = history.parent;
    history.path.event = history.new_event();
    if (scatter(world, seed, history.path, history.parent_vertex, sink)) return true;
  }
  return false;
}

template <class Sink>
STRAY_HD void absorb(Sink& sink, GroupId where, double power) {
  sink.book(BalanceTerm::absorbed, power);
  if constexpr (requires { sink.absorbed(where, power); }) sink.absorbed(where, power);
}

// The stages of a path at a vertex, in this order. A device runs each of them for many paths at once
// (trace/backend/device/history_kernel.hpp).
//
// 1. The path has reached the vertex with path.power: scores of hits. False: the path has ended.
template <class Sink>
STRAY_HD bool arrive(WorldView const& world, History& history, Vertex& vertex, Sink& sink) {
  PathState& path = history.path;
  path.event = history.new_event();
  ++path.order;
  evaluate_scattering(world, path, path.ray.dir, vertex);
  sink.visit(path, vertex);
  score_hit(world, path, vertex, sink);  // hits of lit surfaces, eq. 1.7
  receive(world, path, vertex, sink);
  if (path.order < world.limits.max_order) return true;
  // A connection is one more event, which the walk must be able to sample too.
  sink.book(BalanceTerm::truncated, path.power);
  return false;
}
// 2. Next-event estimates: to every lit surface (eq. 1.8), to receivers, and to sub-paths from them.
template <class Sink>
STRAY_HD void connect_all(WorldView const& world, std::uint64_t seed, History& history, Vertex const& vertex,
                          Sink& sink) {
  PathState const& path = history.path;
  connect(world, seed, path, vertex, history.goal_points, sink);
  connect_receivers(world, seed, path, vertex, history.goal_points, sink);
  connect_sub_paths(world, path, vertex, history.sub_paths, sink);
  if (path.order > 0) score_halo_hits(world, path, vertex, sink);
  connect_halo(world, seed, path, vertex, sink);
}
// 3. The weight window, and the next direction. False: the path has ended.
template <class Sink>
STRAY_HD bool leave(WorldView const& world, std::uint64_t seed, History& history, Vertex const& vertex, Sink& sink) {
  PathState& path = history.path;
  if (path.order == 0) return scatter(world, seed, path, vertex, sink, true);  // the source
  std::uint32_t const children = path.order == 1 ? world.limits.children : 1;
  if (children > 1) have_children(history, vertex, children);
  std::uint32_t const room = may_split(world, history) ? History::most_waiting - history.waiting : 0;
  std::uint32_t const copies = children > 1 ? 1 : control(world, seed, path, vertex, room, sink);
  absorb(sink, world.surfaces[vertex.surface.value].group, children * copies * path.power * (1 - vertex.kept()));
  for (std::uint32_t i = 1; i < copies; ++i) {
    PathState& copy = history.sibling[history.waiting];
    copy = path;
    copy.event = history.new_event();
    if (scatter(world, seed, copy, vertex, sink)) ++history.waiting;
  }
  return copies > 0 && scatter(world, seed, path, vertex, sink);
}

// Processes the hit of the path's ray, or its escape: stage 1 and what happens on the way there. False: the path has
// ended.
template <class Sink>
STRAY_HD bool reach(WorldView const& world, History& history, Hit const& hit, Vertex& vertex, Sink& sink) {
  PathState& path = history.path;
  if (hit.surface.valid()) vertex = vertex_at(world, path, hit);
  double const weight = finish_hop_weight(world, path, hit.surface.valid() ? &vertex : nullptr);
  sink.book(BalanceTerm::sampling, path.power * (path.hop.kept - weight));  // zero on average, which is tested
  path.power *= weight;
  if (path.power == 0) return false;
  if (path.hop.below_facet) {
    absorb(sink, world.surfaces[path.from.surface.value].group, path.power);
    return false;
  }
  pass_planes(world, path, hit.distance, sink);
  absorb(sink, {}, lost_in_medium(world, path, hit.distance));
  if (!hit.surface.valid()) {
    sink.book(BalanceTerm::escaped, path.power);
    return false;
  }
  return arrive(world, history, vertex, sink);
}

// From the hit of the path's ray to its next direction. False: the path has ended.
template <class Sink>
STRAY_HD bool step(WorldView const& world, std::uint64_t seed, History& history, Hit const& hit, Sink& sink) {
  Vertex vertex;
  if (!reach(world, history, hit, vertex, sink)) return false;
  connect_all(world, seed, history, vertex, sink);
  return leave(world, seed, history, vertex, sink);
}
template <class Sink>
STRAY_HD bool step(WorldView const& world, std::uint64_t seed, History& history, Sink& sink) {
  return step(world, seed, history, world.closest(history.path.ray, history.path.from), sink);
}

// Starts a history at an emitter, or where light below the crossover angle has met a surface.
template <class Sink>
STRAY_HD Where start(WorldView const& world, std::uint64_t seed, History& history, Vertex& vertex, Sink& sink) {
  PathState& path = history.path;
  double const n = double(world.emitters.size), draws = world.draws();
  double const place = draws > n && n > 0 ? stratum(seed, path.history, world.block_size) * draws : 0;
  path.strata = {seed, path.history, world.block_size};
  if (world.both_ends) grow_sub_paths(world, seed, path, history.sub_paths, sink);
  if (!(place > n)) return launch(world, seed, path, vertex, sink);
  Rng rng(seed, path.history, 0, Stream::source);
  double u = rng.uniform(), v = rng.uniform();
  path.strata.deal(Dealt::source, u, v);
  if (!start_in_halo(world, (place - n) / (draws - n), u, v, path, vertex)) return Where::nowhere;
  Footprint const& mode = world.lit[path.source];
  sink.emitted(path, make_vertex(world, mode.surface, mode.centre, mode.travel));
  return arrive(world, history, vertex, sink) ? Where::at_vertex : Where::nowhere;
}
// Starts a history and draws its first direction. False: it is over.
template <class Sink>
STRAY_HD bool begin(WorldView const& world, std::uint64_t seed, History& history, Sink& sink) {
  Vertex vertex;
  Where const at = start(world, seed, history, vertex, sink);
  if (at == Where::in_flight) return true;
  if (at == Where::nowhere) return false;
  connect_all(world, seed, history, vertex, sink);
  return leave(world, seed, history, vertex, sink) || next_path(world, seed, history, sink);
}

template <class Sink>
STRAY_HD void trace_history(WorldView const& world, std::uint64_t seed, std::uint64_t number, History& history,
                            Sink& sink) {
  history.begin(number);
  if (!begin(world, seed, history, sink)) return;
  do {
    while (step(world, seed, history, sink)) {
    }
  } while (next_path(world, seed, history, sink));
}
template <class Sink>
STRAY_HD void trace_history(WorldView const& world, std::uint64_t seed, std::uint64_t number, Sink& sink) {
  History history;
  trace_history(world, seed, number, history, sink);
}

}  // namespace straytrace::trace
