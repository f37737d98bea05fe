// SPDX-License-Identifier: BSD-3-Clause
// THE step: one hop and one vertex of one path; and the loop over a history. Everything else prepares the world or adds
// up. docs/theory/path_integral.md; docs/theory/sampling.md.
//
// Sink: where ports, receivers, energy balance and pictures listen; the only output.
//   emitted(path, vertex)                     a history starts: power scattered out of the mode by its first vertex
//   visit(path, vertex)                       light has reached a vertex, with path.power
//   score(path, vertex, lit, connection, y, coupling)  light rejoined the mode of footprint `lit` at the point y
//   score_through(path, vertex, z, chain, receiver, end, power)  optional: power on a receiver by x -> z -> glass
//   score_lit(path, source, z, chain, receiver, end, power)      optional: by z -> glass from the light of a beam on z
//   book(term, power)                         the energy balance
//   absorbed(group, power)                    optional: what of it a group absorbed; no group: a medium
//   roulette_variance(variance)                         optional: of what the roulette has just booked in `window`
#pragma once

#include "trace/step/connect.hpp"
#include "trace/step/emit.hpp"
#include "trace/step/scatter.hpp"
#include "trace/step/specular_connection.hpp"
#include "trace/step/weight_window.hpp"

namespace straytrace {

// All of them carry the same share; those that are not followed at once wait with their parent.
STRAY_HD void have_children(History& history, Vertex const& vertex, std::uint32_t children) {
  history.path.power /= children;
  history.parent = history.path;
  history.parent_vertex = vertex;
  history.children = children - 1;
}
// Sets out with the next path of this history; false: there is none.
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

// The path's ray has met `hit`, or nothing: its next vertex, and how it goes on; false: the path is over.
template <class Sink>
STRAY_HD bool step(WorldView const& world, std::uint64_t seed, History& history, Hit const& hit, Sink& sink) {
  PathState& path = history.path;
  Vertex vertex;
  if (hit.surface.valid()) vertex = vertex_at(world, path, hit);
  double const weight = finish_hop_weight(world, path, hit.surface.valid() ? &vertex : nullptr);
  sink.book(BalanceTerm::sampling, path.power * (path.hop.kept - weight));  // zero on average: that is a test
  path.power *= weight;
  if (path.power == 0) return false;
  pass_planes(world, path, hit.distance, sink);
  absorb(sink, {}, lost_in_medium(world, path, hit.distance));
  if (!hit.surface.valid()) {
    sink.book(BalanceTerm::escaped, path.power);
    return false;
  }
  path.event = history.new_event();
  ++path.order;
  evaluate_scattering(world, path, path.ray.dir, vertex);
  sink.visit(path, vertex);
  score_hit(world, path, vertex, sink);  // light that reached a lit surface by itself, eq. 1.7
  receive(world, path, vertex, sink);
  if (path.order >= world.limits.max_order) {  // a connection is one more event: its weight counts on the walk's share
    sink.book(BalanceTerm::truncated, path.power);
    return false;
  }
  connect(world, seed, path, vertex, sink);  // next-event estimates to every lit surface, eq. 1.8
  connect_receivers(world, seed, path, vertex, sink);
  connect_behind_glass(world, seed, path, vertex, sink);
  std::uint32_t const children = path.order == 1 ? world.limits.children : 1;
  if (children > 1) have_children(history, vertex, children);
  std::uint32_t const most = History::most_waiting - history.waiting;
  std::uint32_t const copies = children > 1 ? 1 : control(world, seed, path, vertex, most, sink);
  absorb(sink, world.surfaces[vertex.surface.value].group, children * copies * path.power * (1 - vertex.kept()));
  for (std::uint32_t i = 1; i < copies; ++i) {
    PathState& copy = history.sibling[history.waiting];
    copy = path;
    copy.event = history.new_event();
    if (scatter(world, seed, copy, vertex, sink)) ++history.waiting;
  }
  return copies > 0 && scatter(world, seed, path, vertex, sink);
}

template <class Sink>
STRAY_HD bool step(WorldView const& world, std::uint64_t seed, History& history, Sink& sink) {
  return step(world, seed, history, world.closest(history.path.ray, history.path.from), sink);
}

template <class Sink>
STRAY_HD void trace_history(WorldView const& world, std::uint64_t seed, std::uint64_t number, History& history,
                            Sink& sink) {
  history.begin(number);
  if (!emit(world, seed, history.path, sink)) return;
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

}  // namespace straytrace
