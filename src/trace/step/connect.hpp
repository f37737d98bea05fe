// SPDX-License-Identifier: BSD-3-Clause
// How light rejoins a mode: the walk hits a lit surface (eq. 1.7), a connection reaches a point drawn on it (eq. 1.8),
// or light scatters once at the source (eq. 1.4). The first two sample the same paths and are combined by the balance
// heuristic in area measure (eq. 1.9). A score is the speckle average of ORDERED paths; C_rev is applied later
// (eq. 1.5). Receivers that count watts: receive.hpp.
#pragma once

#include "base/math/rng.hpp"
#include "trace/step/scatter.hpp"

namespace straytrace::trace {

// Goals are numbered: footprints first, then receivers. The number of a score within its vertex is even for a hit of
// the walk and odd for a connection.
STRAY_HD std::uint32_t arrival_number(std::uint32_t goal) { return 2 * goal; }
STRAY_HD std::uint32_t connection_number(std::uint32_t goal) { return 2 * goal + 1; }
STRAY_HD bool is_hit(std::uint32_t number) { return number % 2 == 0; }

// Density per area of the lit surface with which a connection draws the point y: |u|^2 |cos| (eq. 1.1 over q), 1/m^2.
STRAY_HD double connection_density(Footprint const& lit, Vec3 y, Vec3 normal) {
  return lit.intensity(y) * std::fabs(dot(normal, lit.travel));
}
// Whether the mode lights the point y of its surface: a line parallel to the chief ray, like those that connections
// draw, reaches y before it meets the surface elsewhere (eq. 1.14). The rest of a closed surface lies in its own
// shadow.
STRAY_HD bool lights(WorldView const& world, Footprint const& lit, Vec3 y, Vec3 normal) {
  double const way = dot(y - lit.centre, lit.travel) + lit.backoff;
  if (!(way > 0)) return false;
  Ray line{y - way * lit.travel, lit.travel};
  line.t_max = way - world.slack(lit.surface, way, std::fabs(dot(normal, lit.travel)));
  return !(world.cross(lit.surface.value, line, {}).distance < line.t_max);
}

// BSDF at the lit surface from the direction of arrival into the reversed mode, 1/sr. Light from behind rejoins through
// the surface, with the indices of the vertex.
STRAY_HD double rejoin_bsdf(WorldView const& world, Vertex const& at, Footprint const& lit) {
  Vec3 const out = -lit.direction(at.point), reversed = at.frame.to_local(out);
  if (at.beyond_facet(reversed, out)) return 0;
  if (reversed.z > 0) return scatter_eval(world.laws, *at.optic, at.wi, reversed);
  return scatter_eval(world.laws, *at.optic, at.wi, reversed, at.n_in, at.n_out);
}
STRAY_HD bool scatters_through(Optic const& optic) {
  for (int i = 0; i < optic.laws; ++i)
    if (optic.through[i]) return true;
  return false;
}
// Etendue of one mode in the medium where it arrives, m^2 sr (docs/theory/path_integral.md), times q.
STRAY_HD double accepted(WorldView const& world, Footprint const& lit) {
  double const wavelength = world.wavelength / lit.index;
  return wavelength * wavelength * lit.share;
}

// Share of light of this polarisation, travelling along `out`, that the mode accepts after the scatter at `y`; 1
// without polarisation (docs/theory/conventions.md: BSDF models then describe the main polarisation alone).
STRAY_HD double mode_share(WorldView const& world, Polarisation const& light, Vec3 out, Vertex const& y,
                           Footprint const& lit) {
  if (!world.polarised) return 1;
  Vec3 const reversed = -lit.direction(y.point);
  bool const through = dot(reversed, y.normal()) < 0;
  Polarisation const after = scattered(light, out, reversed, through, y.optic->depolarise);
  return polarisation_overlap(after, lit.polarisation, reversed);
}

template <class Sink>
STRAY_HD void arrive_at(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t index,
                        Sink& sink) {
  Footprint const& lit = world.lit[index];
  double const density = connection_density(lit, vertex.point, vertex.normal());
  if (!(density > 0)) return;
  double const coupling = path.power * rejoin_bsdf(world, vertex, lit) * accepted(world, lit) * density *
                          mode_share(world, path.polarisation, path.ray.dir, vertex, lit);
  // A specular hop has no density: no connection can sample this path.
  double const walk = per_area(path.hop.pdf, vertex.leg, vertex.cosine());
  double const weight = path.hop.pdf > 0 ? walk / (walk + density) : 1;
  if (!(coupling * weight > 0) || !lights(world, lit, vertex.point, vertex.normal())) return;
  sink.score(path, vertex, index, arrival_number(index), vertex, coupling * weight);
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

// The straight line from a vertex to a point: direction, length, and the BSDF models of the vertex in this direction.
struct Way {
  Vec3 out;            // unit vector from the vertex
  Vec3 wo;             // the same, local
  double length = 0;   // m
  double bsdf = 0;     // 1/sr; 0: no light
  double law_pdf = 0;  // 1/sr, with which the models sample it
  double kept = 1;     // share not absorbed on the line
  STRAY_HD double geometry(double cosine) const { return std::fabs(wo.z) * cosine / (length * length); }  // 1/m^2
};
STRAY_HD Way way_to(WorldView const& world, Vertex const& vertex, Vec3 y) {
  Way way;
  Vec3 const span = y - vertex.point;
  way.length = length(span);
  if (!(way.length > 0)) return way;
  way.out = (1 / way.length) * span;
  way.wo = vertex.frame.to_local(way.out);
  if (vertex.beyond_facet(way.wo, way.out)) return way;
  optics::ValueAndPdf const law =
      scatter_both(world.laws, *vertex.optic, vertex.albedos, vertex.wi, way.wo, vertex.n_in, vertex.n_out);
  way.bsdf = law.value;
  way.law_pdf = law.pdf;
  way.kept = kept_along(world, way.wo.z < 0 ? vertex.after : vertex.before, way.length);
  return way;
}
// Density per area with which the walk would have sampled this line, including the choice of the lobe.
STRAY_HD double walk_density(WorldView const& world, PathState const& path, Vertex const& vertex, Way const& way,
                             std::uint32_t patch, double cosine) {
  double const lobe = path.order == 0 ? 1 : vertex.albedo / vertex.kept();
  return lobe * per_area(mixture_pdf(world, vertex.side(), way.law_pdf, patch, way.length, cosine), way.length, cosine);
}
// Whether anything hides y, the far end of the line.
STRAY_HD bool blocked(WorldView const& world, Vertex const& vertex, Way const& way, Vertex const& y) {
  return world.occluded({vertex.point, way.out, way.length - world.slack(y.surface, way.length, y.cosine())},
                        {vertex.surface, vertex.piece, vertex.contact}, vertex.surface == y.surface);
}

// One connection from the vertex to one lit surface.
template <class Sink>
STRAY_HD void connect_to(WorldView const& world, PathState const& path, Vertex const& vertex, std::uint32_t index,
                         double u, double v, Sink& sink) {
  Footprint const& lit = world.lit[index];
  Ray const line = lit.sample(u, v);
  Crossing const met = world.cross(lit.surface.value, line, {});
  if (!(met.distance < infinity)) return;
  Vec3 const point = line.origin + met.distance * line.dir;
  Way const way = way_to(world, vertex, point);
  if (!(way.bsdf > 0)) return;
  Vertex y = make_vertex(world, lit.surface, point, way.out, met.piece);
  if (!(y.wi.z > 0)) return;
  if (dot(y.normal(), lit.travel) >= 0) {  // lit from the other side
    if (!scatters_through(*y.optic)) return;
    y.n_in = way.wo.z < 0 ? vertex.n_out : vertex.n_in;
    y.n_out = lit.index;
  }
  double coupling = path.power * way.bsdf * way.kept * way.geometry(y.cosine()) * rejoin_bsdf(world, y, lit) *
                    accepted(world, lit);  // |u|^2 cos over the density of y is 1
  if (world.polarised)
    coupling *=
        mode_share(world, scattered(path.polarisation, path.ray.dir, way.out, way.wo.z < 0, vertex.optic->depolarise),
                   way.out, y, lit);
  if (!(coupling > 0)) return;
  double weight = 1;
  if (lit.profile != Profile::point && !world.surfaces[lit.surface.value].clear) {  // which a walk can hit
    double const walk = walk_density(world, path, vertex, way, y.patch, y.cosine());
    double const density = connection_density(lit, y.point, y.normal());
    weight = density / (density + walk);
  }
  if (blocked(world, vertex, way, y)) return;
  sink.score(path, vertex, index, connection_number(index), y, coupling * weight);
}

// Whether the sink hears scores of this vertex of the walk.
template <class Sink>
STRAY_HD bool hears(Sink const& sink, PathState const& path) {
  if constexpr (requires { sink.hears(path.event); }) return sink.hears(path.event);
  return true;
}

template <class Sink>
STRAY_HD void connect(WorldView const& world, std::uint64_t seed, PathState const& path, Vertex const& vertex,
                      Sink& sink) {
  if (!(vertex.albedo > 0) || !hears(sink, path)) return;
  Rng rng(seed, path.history, path.event, Stream::connection);
  for (std::uint32_t i = 0; i < world.lit.size; ++i) {
    double const u = rng.uniform(), v = rng.uniform();
    bool const counted = path.from_halo && first_of_mirror(path, path.order, i);  // by the classes `halo`
    if (world.lit[i].receives && !counted) connect_to(world, path, vertex, i, u, v, sink);
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
