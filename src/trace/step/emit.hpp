// SPDX-License-Identifier: BSD-3-Clause
// The first vertex of a history: a point on a lit surface, drawn with the mode's own weight |u|^2
// (docs/theory/path_integral.md, eq. 1.6), where light is scattered out of the mode. Specular reflection of the mode is
// the mode itself, not stray light.
#pragma once

#include "trace/step/scatter.hpp"
#include "trace/step/specular_connection.hpp"

namespace straytrace {

// A beam that starts in empty space: from its plane along the local normal of its wavefront.
template <class Sink>
STRAY_HD bool emit_free(Footprint const& beam, Ray const& line, PathState& path, Sink& sink) {
  Vertex start;  // on no surface
  start.point = line.origin + beam.backoff * beam.travel;
  path.emitted = path.power;
  path.ray = {start.point, beam.direction(start.point)};
  path.hop.left_by = Event::emit;
  path.coherent = true;
  path.path_length = beam.lag(start.point);
  path.route = extended(path.route, beam.origin, Event::emit);
  sink.emitted(path, start);
  return true;
}

// Histories of a block are dealt to sources and first targets by systematic sampling (docs/theory/sampling.md): evenly
// spaced numbers in (0, 1) with one random shift per block.
STRAY_HD double stratum(std::uint64_t seed, std::uint64_t history, std::uint64_t block_size) {
  std::uint64_t const place = history % block_size;
  double const shift = Rng(seed, history - place, 0xffffffffu, Stream::source).uniform();
  double const x = (double(place) + shift) / double(block_size);
  return x < 1 ? x : x - 1;
}

// Starts a history: its source, first vertex and first direction. False where no light goes on.
template <class Sink>
STRAY_HD bool emit(WorldView const& world, std::uint64_t seed, PathState& path, Sink& sink) {
  auto const n = static_cast<std::uint32_t>(world.emitters.size);
  if (n == 0) return false;  // nothing lit scatters
  Rng rng(seed, path.history, 0, Stream::source);
  double const place = stratum(seed, path.history, world.block_size) * n;
  auto pick = static_cast<std::uint32_t>(place);
  if (pick >= n) pick = n - 1;
  path.stratum = place - pick;
  path.source = world.emitters[pick];
  Footprint const& lit = world.lit[path.source];
  path.polarisation = lit.polarisation;
  path.power = lit.share * n;
  double const u = rng.uniform(), v = rng.uniform();
  Ray const line = lit.sample(u, v);
  Crossing const met = lit.free ? Crossing{} : world.cross(lit.surface.value, line, {});
  if (!(met.distance < infinity)) {  // a free beam, or beside the clear aperture: that share is clipped, not scattered
    connect_behind_glass(world, seed, path, {}, sink);
    return lit.free && emit_free(lit, line, path, sink);
  }
  Vec3 const point = line.origin + met.distance * line.dir;
  path.ray.dir = lit.direction(point);
  Vertex vertex = make_vertex(world, lit.surface, point, path.ray.dir, met.piece);
  evaluate_scattering(world, path, path.ray.dir, vertex);
  path.emitted = path.power * vertex.albedo;
  if (lit.profile != Profile::point) path.reached_pdf = connection_density(lit, vertex.point, vertex.frame.e3) / n;
  sink.emitted(path, vertex);
  if (!lit.standing) score_single(world, path, vertex, lit, sink);
  connect(world, seed, path, vertex, sink);
  connect_receivers(world, seed, path, vertex, sink);
  connect_behind_glass(world, seed, path, vertex, sink);
  return scatter(world, seed, path, vertex, sink, true);
}

}  // namespace straytrace
