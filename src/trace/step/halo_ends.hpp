// SPDX-License-Identifier: BSD-3-Clause
// Light that the mirrors of a cavity scatter below the crossover angle, at both ends of a path (docs/theory/wave.md,
// eq. W.60 to W.62): histories that start where it meets a surface, and light that such a surface scatters back into
// the mode. On the route it has been at the mirror, as light beyond the angle has.
//
// Light from a mirror to one surface and straight back to the same mirror is the deterministic class `halo` (eq. W.21)
// wherever one of both ways is below the angle; it is not scored here.
#pragma once

#include "trace/step/connect.hpp"

namespace straytrace::trace {

// Irradiance of a source where its light meets the lit side of the vertex, across the beam, over the power of the mode,
// 1/m^2; 0: none. As `lights` does for footprints, it asks whether the surface itself is in the way.
STRAY_HD double halo_irradiance(WorldView const& world, HaloSource const& source, Vertex const& y) {
  double const cosine = -dot(source.travel, y.normal());
  if (!(cosine > 0)) return 0;
  Halo const& halo = world.halo;
  Vec3 const local = halo.frame.local_point(y.point);
  std::uint32_t const cell = halo.cell_at(source, y.surface, local);
  if (cell == Halo::none) return 0;
  HaloCell const& found = halo.cells[cell];
  Ray line = halo.line_at(source, halo.sections[found.section], local.x, local.y);
  double const way = dot(y.point - line.origin, line.dir);
  line.t_max = way - world.slack(y.surface, way, cosine);
  return world.cross(y.surface.value, line, {}).distance < line.t_max ? 0 : double(found.irradiance);
}

// Light that the vertex y scatters back along the way that the light of a source came, into its mode: BSDF times
// etendue times the share of the polarisation, m^2. `travel`: of the light that arrives at y, with the state `light`.
STRAY_HD double back_into_halo(WorldView const& world, Polarisation const& light, Vec3 travel, Vertex const& y,
                               HaloSource const& source) {
  Footprint const& mode = world.lit[source.footprint];
  Vec3 const out = -source.travel;
  double const f = scatter_eval(world.laws, *y.optic, y.wi, y.frame.to_local(out));
  if (!world.polarised) return f * accepted(world, mode);
  Polarisation const at_mirror = scattered(light, travel, out, false, y.optic->depolarise);
  Polarisation const after = scattered(at_mirror, out, -mode.travel, false, 0);
  return f * accepted(world, mode) * polarisation_overlap(after, mode.polarisation, -mode.travel);
}

// The walk has met a surface in the light of a source (eq. 1.7 with |psi|^2).
template <class Sink>
STRAY_HD void score_halo_hit(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t index,
                             Sink& sink) {
  HaloSource const& source = world.halo.sources[index];
  if (!world.lit[source.footprint].receives || first_of_mirror(path, path.order, source.footprint)) return;
  double const irradiance = halo_irradiance(world, source, vertex);
  if (!(irradiance > 0)) return;
  double const density = -irradiance * dot(source.travel, vertex.normal());  // per area of the surface
  double const walk = per_area(path.hop.pdf, vertex.leg, vertex.cosine());
  double const weight = path.hop.pdf > 0 ? weight_of(walk, density / source.power) : 1;
  double const coupling =
      path.power * density * back_into_halo(world, path.polarisation, path.ray.dir, vertex, source) * weight;
  if (coupling > 0) sink.score_halo(path, vertex, vertex, index, false, coupling);
}

// One connection from the vertex to a point drawn in the light of a source (eq. 1.8).
template <class Sink>
STRAY_HD void connect_to_halo(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t index,
                              Rng& rng, Sink& sink) {
  HaloSource const& source = world.halo.sources[index];
  double const choice = rng.uniform(), u = rng.uniform(), v = rng.uniform();
  if (!world.lit[source.footprint].receives || first_of_mirror(path, path.order + 1, source.footprint)) return;
  HaloPoint const drawn = world.halo.draw(source, choice, u, v);
  SurfaceId const surface = world.halo.cells[drawn.cell].surface;
  Crossing const met = world.cross(surface.value, drawn.line, {});
  if (!(met.distance < drawn.line.t_max)) return;
  Vec3 const point = drawn.line.origin + met.distance * drawn.line.dir;
  Way const way = way_to(world, vertex, point);
  if (!(way.bsdf > 0)) return;
  Vertex const y = make_vertex(world, surface, point, way.out, met.piece);
  double const cosine = -dot(source.travel, y.normal());
  if (!(y.wi.z > 0 && cosine > 0)) return;
  Polarisation light = path.polarisation;
  if (world.polarised) light = scattered(light, path.ray.dir, way.out, way.wo.z < 0, vertex.optic->depolarise);
  double const irradiance = double(world.halo.cells[drawn.cell].irradiance);
  double const density = irradiance * cosine / source.power;
  double const coupling = path.power * way.bsdf * way.kept * way.geometry(y.cosine()) *
                          back_into_halo(world, light, way.out, y, source) * source.power;
  if (!(coupling > 0) || blocked(world, vertex, way, y)) return;
  double const walk = walk_density(world, path, vertex, way, y.patch, y.cosine());
  sink.score_halo(path, vertex, y, index, true, coupling * weight_of(density, walk));
}

template <class Sink>
STRAY_HD void score_halo_hits(WorldView const& world, PathState const& path, Vertex const& vertex, Sink& sink) {
  if constexpr (requires { sink.score_halo(path, vertex, vertex, 0u, false, 0.0); })
    for (std::uint32_t i = 0; i < world.halo.sources.size; ++i) score_halo_hit(world, path, vertex, i, sink);
}

// The point y is one more vertex before the mirror.
template <class Sink>
STRAY_HD void connect_halo(WorldView const& world, std::uint64_t seed, PathState const& path, Vertex const& vertex,
                           Sink& sink) {
  if constexpr (requires { sink.score_halo(path, vertex, vertex, 0u, false, 0.0); }) {
    if (!world.halo.on() || !(vertex.albedo > 0) || path.order + 1 >= world.limits.max_order) return;
    Rng rng(seed, path.history, path.event, Stream::halo);
    for (std::uint32_t i = 0; i < world.halo.sources.size; ++i) connect_to_halo(world, path, vertex, i, rng, sink);
  }
}

// A history whose mirror has scattered below the crossover angle: path and first vertex, where the light meets a
// surface, drawn by power. `choice` is uniform in (0, 1). False: it misses the surface.
STRAY_HD bool start_in_halo(WorldView const& world, double choice, double u, double v, PathState& path,
                            Vertex& vertex) {
  Halo const& halo = world.halo;
  double const place = choice * halo.emitted;
  std::uint32_t index = 0;
  for (std::uint32_t i = 1; i < halo.sources.size; ++i)
    if (world.lit[halo.sources[i].footprint].emits && halo.sources[i].emitted_before <= place) index = i;
  HaloSource const& source = halo.sources[index];
  HaloPoint const drawn = halo.draw(source, (place - source.emitted_before) / source.power, u, v);
  SurfaceId const surface = halo.cells[drawn.cell].surface;
  Crossing const met = world.cross(surface.value, drawn.line, {});
  if (!(met.distance < drawn.line.t_max)) return false;
  Vec3 const point = drawn.line.origin + met.distance * drawn.line.dir;
  Footprint const& mode = world.lit[source.footprint];
  Vec3 const span = point - mode.centre;
  path.source = source.footprint;
  path.from_halo = true;
  path.power = path.emitted = mode.share * halo.emitted / halo.share;
  path.polarisation = scattered(mode.polarisation, mode.travel, unit(span), false, 0);
  path.path_length = length(span);
  path.ray = {mode.centre, unit(span)};
  path.hop.left_by = Event::scatter;
  path.route = extended(path.route, world.surfaces[mode.surface.value].group, Event::scatter);
  vertex = make_vertex(world, surface, point, path.ray.dir, met.piece);
  vertex.leg = path.path_length;
  return vertex.wi.z > 0;
}

}  // namespace straytrace::trace
