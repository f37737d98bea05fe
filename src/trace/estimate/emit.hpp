// SPDX-License-Identifier: BSD-3-Clause
// The first vertex of a history: a point on a lit surface, drawn with the mode's own weight |u|^2 (physics.md eq. 1.6),
// where light is scattered out of the mode. Specular reflection of the mode is the mode itself, not stray light.
#pragma once

#include "trace/estimate/connect.hpp"
#include "trace/estimate/scatter.hpp"

namespace straytrace {

template <class Sink>
STRAY_HD bool emit(WorldView const& world, std::uint64_t seed, std::uint64_t history, PathState& path, Sink& sink) {
  Rng rng(seed, history, 0, Stream::source);
  auto const n = static_cast<std::uint32_t>(world.emitters.size);
  auto pick = static_cast<std::uint32_t>(rng.uniform() * n);
  if (pick >= n) pick = n - 1;
  path.history = history;
  path.source = world.emitters[pick];
  Footprint const& lit = world.lit[path.source];
  double const u = rng.uniform(), v = rng.uniform();
  Ray const line = lit.sample(u, v);
  Crossing const met = world.cross(lit.surface.value, line, {});
  if (!(met.distance < infinity))
    return false;  // beside the clear aperture: that share of the mode is clipped, not scattered
  Vec3 const point = line.origin + met.distance * line.dir;
  Vertex const vertex = make_vertex(world, lit.surface, point, lit.direction(point), met.piece);
  path.power = lit.share * n;
  path.emitted = path.power * vertex.albedo;
  sink.emitted(path, vertex);
  if (!lit.standing) score_single(world, path, vertex, lit, sink);
  connect(world, seed, path, vertex, sink);
  return scatter(world, seed, path, vertex, sink, true);
}

}  // namespace straytrace
