// SPDX-License-Identifier: BSD-3-Clause
// Receivers behind lenses and mirrors (docs/theory/sampling.md): connections do not reach them, and the walk rarely
// hits a small one. A sub-path starts on the receiver, walks backwards through specular surfaces to the first
// scattering surface z, and the vertex x of the walk is connected to z. It is combined with the walk that goes x -> z
// -> glass -> receiver without a connection by the balance heuristic, in area at z times projected solid angle from z
// [1/(m^2 sr)], where the sub-path has the density of its start (start_density): etendue is the same at both ends.
// Where a sub-path meets a surface that a beam lights, directly or as a free beam by the straight way from its plane,
// that light's own scatter is scored as well, weighed against the walk that starts with it.
#pragma once

#include "trace/step/receive.hpp"
#include "trace/step/scatter.hpp"

namespace straytrace::trace {

constexpr std::uint32_t most_specular_hops = 32;  // of a backward sub-path; longer chains are left to the walk

// End of a backward sub-path.
struct Backward {
  Vec3 end, arriving;  // on the receiver; direction of the light there
  std::uint32_t end_piece = 0;
  double etendue = 0;  // 1 over the density with which it started, m^2 sr
  SurfaceId z;
  std::uint32_t piece = 0;
  Vec3 point, towards;                    // on z; unit vector from there back into the glass
  double tau = 0;                         // shares passed over the probabilities of choosing them; 0: nothing found
  double distance = 0;                    // m from z to the next specular surface
  double cosine = 1;                      // of incidence there, on the side of z
  std::uint32_t patch = WorldView::none;  // of that surface
};

// Direction of a sub-path from a point of the receiver; zero: none.
STRAY_HD Vec3 start_direction(WorldView const& world, Receiver const& r, Vec3 start, Vec3 normal, Rng& rng) {
  double const a = rng.uniform(), b = rng.uniform();
  double const choice = r.aims > 0 ? rng.uniform() / Receiver::aimed_share : 1;
  if (choice < 1) {
    SurfaceId const aim = r.aim[static_cast<std::uint32_t>(choice * r.aims)];
    Vec3 const span = world.shapes.visit(world.surfaces[aim.value].shape, [&](auto const& s) {
      return sample_of(s, a, b).point;
    }) - start;
    double const far = length(span);
    if (!(far > 0)) return {};
    Ray const out{start, (1 / far) * span};
    Crossing const met = world.cross(aim.value, out, {});
    if (!(met.distance < infinity)) return {};
    double const cosine = std::fabs(dot(world.normal(aim, start + met.distance * out.dir, met.piece), out.dir));
    bool const same = std::fabs(met.distance - far) <= world.slack(aim, far, cosine);
    return same ? out.dir : Vec3{};  // a nearer part of the surface has its own density
  }
  bool const front = r.sides() == 2 ? rng.uniform() < 0.5 : r.front;
  SinCos const azimuth = sincos_turn(b);
  double const rho = std::sqrt(a);
  return Frame::around(front ? normal : -normal).to_world({rho * azimuth.cos, rho * azimuth.sin, std::sqrt(1 - a)});
}

// Calls `passed(vertex, way)` for every specular surface, starting at the receiver, and `met(back)` for every
// surface behind one, whether the sub-path ends there or not, with the tau reached so far.
template <class Passed, class Met>
STRAY_HD Backward backward_from(WorldView const& world, Receiver const& r, Rng& rng, Passed&& passed, Met&& met) {
  double const u = rng.uniform(), v = rng.uniform();
  SurfacePoint const start =
      world.shapes.visit(world.surfaces[r.surface.value].shape, [&](auto const& s) { return sample_of(s, u, v); });
  Vec3 const normal = world.normal(r.surface, start.point, start.piece);
  PathState path;
  path.power = 1;
  path.ray = {start.point, start_direction(world, r, start.point, normal, rng)};
  path.from = {r.surface, start.piece};
  double const cosine = dot(path.ray.dir, normal);
  if (cosine == 0 || !r.counts(cosine > 0)) return {};
  Backward back;
  back.end = start.point;
  back.arriving = -path.ray.dir;
  back.end_piece = start.piece;
  back.etendue = 1 / start_density(world, r, path.ray, std::fabs(cosine));
  for (std::uint32_t hops = 0; hops <= most_specular_hops; ++hops) {
    Hit const hit = world.closest(path.ray, path.from);
    if (!hit.surface.valid()) return {};
    Vertex at = vertex_at(world, path, hit);
    lost_in_medium(world, path, hit.distance);
    evaluate_scattering(world, path, path.ray.dir, at);
    back.z = at.surface;
    back.piece = at.piece;
    back.point = at.point;
    back.towards = -path.ray.dir;
    back.distance = at.leg;
    back.tau = path.power;
    if (hops > 0) met(back);
    double const choice = rng.uniform() * at.kept();
    if (choice >= at.reflect + at.transmit) {        // scattered or absorbed here
      if (hops == 0 || !(at.albedo > 0)) return {};  // direct view: left to the ordinary connection
      back.tau *= at.kept() / at.albedo;
      return back;
    }
    bool const through = choice >= at.reflect;
    SpecularWay const way = specular_way(world, path.ray.dir, at, through, through ? choice - at.reflect : choice);
    passed(at, way);
    path.power *= at.kept();
    path.from = {at.surface, at.piece, at.contact};
    path.ray.origin = at.point;
    path.media = at.before;
    leave_specular(world, path, at, way);
    back.patch = at.patch;
    back.cosine = std::fabs(dot(path.ray.dir, at.normal()));
  }
  return {};
}
STRAY_HD Rng backward_numbers(std::uint64_t seed, PathState const& path, std::uint32_t receiver) {
  return {seed, path.history, path.event, static_cast<Stream>(std::uint32_t(Stream::backward) + (receiver << 8))};
}

// Names of the specular surfaces of a sub-path, nearest the receiver first.
struct Chain {
  std::uint64_t name[most_specular_hops + 1];
  std::uint32_t hops = 0;
  STRAY_HD void add(WorldView const& world, Vertex const& at, Event event) {
    name[hops++] = std::uint64_t(world.surfaces[at.surface.value].group.value) << 8 | std::uint64_t(event);
  }
};

// The same etendue as seen at z towards `wo`, m^2 sr: over n^2 it is conserved (docs/theory/surfaces.md, eq. 3.2);
// receivers stand outside all glass.
STRAY_HD double etendue_at(Backward const& back, Vertex const& z, Vec3 wo) {
  double const n = wo.z < 0 ? z.n_out : z.n_in;
  return back.etendue / (n * n);
}

// Light of a beam where a sub-path meets a surface.
struct Lit {
  Vec3 travel;
  double density = 0;  // over the power of the beam, per area of the surface, 1/m^2; 0: none
};
STRAY_HD Lit light_at(WorldView const& world, Footprint const& beam, Vec3 point, SurfaceId surface, Vec3 normal) {
  if (beam.profile == Profile::point) return {};
  if (!beam.free) {
    bool const lit = beam.surface == surface && lights(world, beam, point, normal);
    return {beam.direction(point), lit ? connection_density(beam, point, normal) : 0};
  }
  Footprint::Passing const light = beam.passing(point);
  double const cosine = std::fabs(dot(normal, light.travel)), density = light.irradiance * cosine;
  if (!(density > 0)) return {};
  double const way = length(point - light.start), clear = way - world.slack(surface, way, cosine);
  return {light.travel, world.occluded({light.start, light.travel, clear}, {}) ? 0 : density};
}

// Light of the beam `source`, scattered once where a sub-path meets it: irradiance x BSDF x etendue.
template <class Sink>
STRAY_HD void score_lit_behind(WorldView const& world, PathState const& path, std::uint32_t source,
                               Backward const& back, Chain const& chain, std::uint32_t receiver, Sink& sink) {
  Footprint const& beam = world.lit[source];
  if (chain.hops + (beam.free ? 1 : 0) >= world.limits.max_order) return;
  Lit const lit = light_at(world, beam, back.point, back.z, world.normal(back.z, back.point, back.piece));
  if (!(lit.density > 0)) return;
  Vertex z = make_vertex(world, back.z, back.point, lit.travel, back.piece);
  PathState there;
  there.polarisation = beam.polarisation;
  evaluate_scattering(world, there, lit.travel, z);
  Vec3 const wo = z.frame.to_local(back.towards);
  if (z.beyond_facet(wo, back.towards)) return;
  optics::ValueAndPdf const law = scatter_both(world.laws, *z.optic, z.albedos, z.wi, wo, z.n_in, z.n_out);
  double const f = law.value;
  if (!(f > 0)) return;
  double const etendue = etendue_at(back, z, wo);
  double const lobe = beam.free ? z.albedo / z.kept() : 1;
  double const leaving =
      lobe * mixture_pdf(world, z.side(), law.pdf, back.patch, back.distance, back.cosine) / std::fabs(wo.z);
  double const walk = lit.density / world.draws() * leaving;
  double const power = beam.share * lit.density * f * back.tau * etendue / (1 + walk * etendue);
  Vertex const end = make_vertex(world, world.receivers[receiver].surface, back.end, back.arriving, back.end_piece);
  if (power > 0) sink.score_lit(path, source, z, chain, receiver, end, power);
}

// Connects the vertex x to the end of a sub-path.
template <class Sink>
STRAY_HD void connect_through(WorldView const& world, PathState const& path, Vertex const& vertex, Backward const& back,
                              Chain const& chain, std::uint32_t receiver, Sink& sink) {
  if (!(back.tau > 0) || path.order + chain.hops + 2 > world.limits.max_order) return;
  Way const way = way_to(world, vertex, back.point);
  if (!(way.bsdf > 0)) return;
  Vertex z = make_vertex(world, back.z, back.point, way.out, back.piece);
  if (!(z.wi.z > 0)) return;
  PathState there;  // media at z: those of the way there
  there.media = way.wo.z < 0 ? vertex.after : vertex.before;
  there.polarisation = path.polarisation;
  evaluate_scattering(world, there, way.out, z);
  Vec3 const wo = z.frame.to_local(back.towards);
  if (z.beyond_facet(wo, back.towards)) return;
  optics::ValueAndPdf const law = scatter_both(world.laws, *z.optic, z.albedos, z.wi, wo, z.n_in, z.n_out);
  double const f = law.value;
  if (!(f > 0) || blocked(world, vertex, way, z)) return;
  double const etendue = etendue_at(back, z, wo);
  double const leaving = z.albedo / z.kept() *
                         mixture_pdf(world, z.side(), law.pdf, back.patch, back.distance, back.cosine) /
                         std::fabs(wo.z);
  double const walk = walk_density(world, path, vertex, way, z.patch, z.cosine()) * leaving;
  double const power =
      path.power * way.bsdf * way.kept * way.geometry(z.cosine()) * f * back.tau * etendue / (1 + walk * etendue);
  if (!(power > 0)) return;
  Vertex const end = make_vertex(world, world.receivers[receiver].surface, back.end, back.arriving, back.end_piece);
  if constexpr (requires { sink.score_through(path, vertex, z, chain, receiver, end, power); })
    sink.score_through(path, vertex, z, chain, receiver, end, power);
}

// One sub-path for each receiver behind glass. At the start of every history it scores the light of all beams on the
// surfaces that it meets; a `vertex` that scatters is connected to its end.
template <class Sink>
STRAY_HD void connect_behind_glass(WorldView const& world, std::uint64_t seed, PathState const& path,
                                   Vertex const& vertex, Sink& sink) {
  constexpr bool hears_lit = requires(Vertex const& v, Chain const& c) { sink.score_lit(path, 0u, v, c, 0u, v, 0.0); };
  bool const starts = hears_lit && path.event == 0, connects = vertex.albedo > 0;
  if (!starts && !connects) return;
  for (std::uint32_t receiver = 0; receiver < world.receivers.size; ++receiver) {
    if (!world.receivers[receiver].behind_glass) continue;
    Rng rng = backward_numbers(seed, path, receiver);
    Chain chain;
    Backward const back = backward_from(
        world, world.receivers[receiver], rng,
        [&](Vertex const& at, SpecularWay const& way) { chain.add(world, at, way.event()); },
        [&](Backward const& met) {
          if constexpr (hears_lit)
            for (std::size_t i = 0; starts && i < world.emitters.size; ++i)
              score_lit_behind(world, path, world.emitters[i], met, chain, receiver, sink);
        });
    if (connects) connect_through(world, path, vertex, back, chain, receiver, sink);
  }
}

}  // namespace straytrace::trace
