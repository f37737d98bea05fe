// SPDX-License-Identifier: BSD-3-Clause
// First-order stray light: surfaces that are lit (illuminated) and surfaces that are seen (critical), directly or by
// mirrors and lenses. A surface on both lists causes first-order stray light. Page: docs/reference/commands.md.
#pragma once

#include <vector>

#include "base/math/rng.hpp"
#include "trace/run/trace.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {

// Start of a backward walk: a place where light can arrive. A port (a lit surface and its mode) or a receiver.
struct Ending {
  bool port = false;
  std::uint32_t index = 0;  // footprint or receiver
};
std::vector<Ending> endings_of(WorldView const&);

// Backward walks have numbers of their own, away from those of histories.
constexpr std::uint64_t first_backward_history = std::uint64_t{1} << 62;

// Follows a path that has been started, as long as it meets specular surfaces; calls `visit(path, vertex)` for each
// surface reached, with path.power there. Scattered light ends. Calls `escaped(path.power)` for light that escapes.
template <class Visit, class Escaped>
void follow_specular(WorldView const& world, std::uint64_t seed, PathState& path, Visit&& visit, Escaped&& escaped) {
  NullSink sink;
  while (path.order < world.limits.max_order) {
    Hit const hit = world.closest(path.ray, path.from);
    Vertex vertex;
    if (hit.surface.valid()) vertex = vertex_at(world, path, hit);
    path.power *= finish_hop_weight(world, path, hit.surface.valid() ? &vertex : nullptr);
    lost_in_medium(world, path, hit.surface.valid() ? hit.distance : 0);
    if (!(path.power > 0)) return;
    if (!hit.surface.valid()) return escaped(path.power);
    ++path.event;
    ++path.order;
    evaluate_scattering(world, path, path.ray.dir, vertex);
    visit(path, vertex);
    if (!scatter(world, seed, path, vertex, sink) || path.hop.left_by == Event::scatter) return;
  }
}

// Starts backward walk number `number` from an ending. path.power is the throughput of the walk: for a receiver the
// etendue pi A [m^2 sr], for a port lambda^2 times its share [m^2], to which the hop adds its weight on arrival.
bool start_backward(WorldView const&, std::uint64_t seed, std::uint64_t number, Ending, PathState& path);

// One row: a group of surfaces. Errors are one standard error.
struct FirstOrderRow {
  GroupId group;
  Estimate power;       // arriving there by specular paths only, relative to the main mode
  Estimate throughput;  // m^2 sr, with which the ending sees it
  Estimate product;     // single scatter there into the ending, relative to the main mode
};
struct FirstOrderList {
  Ending ending;
  std::vector<FirstOrderRow> rows;  // one per group that is lit or seen, largest product first
  Estimate outside;                 // throughput of paths that escape
  double total = 0;                 // total throughput
};

struct FirstOrderSettings {
  std::uint64_t seed = 1, histories = 1 << 17;  // forward, and for each ending backward
  unsigned threads = 0;
};
// The product adds, strip by strip and side by side, (scattered power) x (throughput)/(pi area): exact for a Lambertian
// surface that is lit or seen evenly within each strip.
std::vector<FirstOrderList> first_order(World const&, FirstOrderSettings const&);

}  // namespace straytrace::trace
