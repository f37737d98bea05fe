// SPDX-License-Identifier: BSD-3-Clause
// THE step: one hop and one vertex of one path; and the loop over a history. Everything else prepares the world or adds
// up. physics.md 1.4; estimators.md 4.
//
// Sink: where ports, receivers, books and pictures listen; the only output.
//   emitted(path, vertex)                     a history starts: power scattered out of the mode by its first vertex
//   visit(path, vertex)                       light has reached a vertex, with path.power
//   score(path, vertex, lit, connection, y, coupling)  light rejoined the mode of footprint `lit` at the point y
//   book(fate, power)                         the ledger
#pragma once

#include "trace/estimate/connect.hpp"
#include "trace/estimate/control.hpp"
#include "trace/estimate/emit.hpp"
#include "trace/estimate/scatter.hpp"

namespace straytrace {

// Follows the path to its next vertex and decides how it goes on; false: the path is over.
template <class Sink>
STRAY_HD bool step(WorldView const& world, std::uint64_t seed, History& history, Sink& sink) {
  PathState& path = history.path;
  Hit const hit = world.closest(path.ray, path.from);
  Vertex vertex;
  if (hit.surface.valid()) {
    vertex = make_vertex(world, hit.surface, path.ray.origin + hit.distance * path.ray.dir, path.ray.dir, hit.piece);
    vertex.leg = hit.distance;
  }
  double const weight = complete(world, path, hit.surface.valid() ? &vertex : nullptr);
  sink.book(Fate::sampling, path.power * (path.hop.kept - weight));  // zero on average: that is a test
  path.power *= weight;
  if (!(path.power != 0)) return false;
  if (!hit.surface.valid()) {
    sink.book(Fate::escaped, path.power);
    return false;
  }
  path.event = history.new_event();
  ++path.order;
  sink.visit(path, vertex);
  arrive(world, path, vertex, sink);           // light that reached a lit surface by itself, eq. 1.7
  if (path.order >= world.limits.max_order) {  // a connection is one more event: its weight counts on the walk's share
    sink.book(Fate::limit, path.power);
    return false;
  }
  connect(world, seed, path, vertex, sink);  // next-event estimates to every lit surface, eq. 1.8
  std::uint32_t const copies = control(world, seed, path, vertex, History::most_waiting - history.waiting, sink);
  sink.book(Fate::absorbed, copies * path.power * (1 - vertex.kept()));
  for (std::uint32_t i = 1; i < copies; ++i) {
    PathState copy = path;
    copy.event = history.new_event();
    if (scatter(world, seed, copy, vertex, sink)) history.sibling[history.waiting++] = copy;
  }
  return copies > 0 && scatter(world, seed, path, vertex, sink);
}

template <class Sink>
STRAY_HD void trace_history(WorldView const& world, std::uint64_t seed, std::uint64_t number, Sink& sink) {
  History history;
  if (!emit(world, seed, number, history.path, sink)) return;
  do {
    while (step(world, seed, history, sink)) {
    }
  } while (history.next_sibling());
}

}  // namespace straytrace
