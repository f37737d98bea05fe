// SPDX-License-Identifier: BSD-3-Clause
// THE step: one hop and one vertex of one path; and the loop over a history. Everything else prepares the world or adds
// up. physics.md 1.4; estimators.md 4.
//
// Sink: where ports, books and pictures listen; the only output.
//   emitted(path, vertex)                     a history starts: power scattered out of the mode by its first vertex
//   visit(path, vertex)                       light has reached a vertex, with path.power
//   score(path, vertex, lit, connection, y, coupling)  light rejoined the mode of footprint `lit` at the point y
//   book(fate, power)                         the ledger
#pragma once

#include "trace/estimate/connect.hpp"
#include "trace/estimate/emit.hpp"
#include "trace/estimate/roulette.hpp"
#include "trace/estimate/scatter.hpp"

namespace straytrace {

// Follows the path to its next vertex and decides how it goes on; false: the path is over.
template <class Sink>
STRAY_HD bool step(WorldView const& world, std::uint64_t seed, PathState& path, Sink& sink) {
  Hit const hit = world.closest(path.ray, path.from);
  if (!hit.surface.valid()) {
    sink.book(Fate::escaped, path.power);
    return false;
  }
  Vertex vertex =
      make_vertex(world, hit.surface, path.ray.origin + hit.distance * path.ray.dir, path.ray.dir, hit.piece);
  vertex.leg = hit.distance;
  ++path.event;
  sink.visit(path, vertex);
  arrive(world, path, vertex, sink);           // light that reached a lit surface by itself, eq. 1.7
  if (path.event >= world.limits.max_order) {  // a connection is one more event: its weight counts on the walk's share
    sink.book(Fate::limit, path.power);
    return false;
  }
  connect(world, seed, path, vertex, sink);  // next-event estimates to every lit surface, eq. 1.8
  double const kept = vertex.albedo + vertex.optic->reflect;
  if (!survives(world, seed, path, sink)) return false;
  sink.book(Fate::absorbed, path.power * (1 - kept));
  return scatter(world, seed, path, vertex, sink);
}

template <class Sink>
STRAY_HD void trace_history(WorldView const& world, std::uint64_t seed, std::uint64_t history, Sink& sink) {
  PathState path;
  if (!emit(world, seed, history, path, sink)) return;
  while (step(world, seed, path, sink)) {
  }
}

}  // namespace straytrace
