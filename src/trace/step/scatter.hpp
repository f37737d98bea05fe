// SPDX-License-Identifier: BSD-3-Clause
// The next direction of a path. The lobe is chosen by its share of the light that leaves the vertex; within the
// scattered lobe the direction is drawn from the mixture of BSDF model and targets, in solid angle at the vertex left
// (docs/theory/sampling.md):
//   p(w) = alpha p_BSDF(w) + (1 - alpha) q_k d^2/(A_k cos_y)      k: the patch that is hit first along w
// One sample and one division, whichever component drew it. The BSDF model always takes part (alpha >= 0.1), so no
// light is missed for lack of a target.
#pragma once

#include "trace/step/balance.hpp"

namespace straytrace::trace {

// The part of the targets: density [1/sr] of aiming from `side` at `patch`, at `distance` under `cosine`.
STRAY_HD double aimed_pdf(WorldView const& world, std::uint32_t side, std::uint32_t patch, double distance,
                          double cosine) {
  if (side == WorldView::none || patch == WorldView::none) return 0;
  return per_solid_angle(world.steering.density(world.steering.sides[side], patch), distance, cosine);
}
STRAY_HD double law_share(WorldView const& world, std::uint32_t side) {
  return side == WorldView::none ? 1 : world.steering.sides[side].alpha;
}
STRAY_HD double mixture_pdf(WorldView const& world, std::uint32_t side, double law_pdf, std::uint32_t patch,
                            double distance, double cosine) {
  double const alpha = law_share(world, side);
  return alpha < 1 ? alpha * law_pdf + (1 - alpha) * aimed_pdf(world, side, patch, distance, cosine) : law_pdf;
}

// Whether a ray met the point of `aim` that it was aimed at. A hit that is nearer by more than rounding hides the
// point.
STRAY_HD bool met_aim(WorldView const& world, Hop const& hop, Vertex const* met) {
  if (!met || met->surface != hop.aim) return false;
  return met->leg >= hop.aim_distance - world.slack(hop.aim, hop.aim_distance, met->cosine());
}

// Weight of the hop once its end is known; 0 when something hides the target. Sets hop.pdf. `vertex`: where the ray
// arrived; null when it escaped.
STRAY_HD double finish_hop_weight(WorldView const& world, PathState& path, Vertex const* vertex) {
  Hop& hop = path.hop;
  if (!(hop.law_pdf > 0) && !hop.aim.valid()) {  // specular
    hop.pdf = 0;
    return hop.value / hop.lobe;
  }
  if (hop.aim.valid() && !met_aim(world, hop, vertex)) {
    hop.pdf = 0;
    return 0;
  }
  double const alpha = law_share(world, hop.side);
  double const aimed =
      vertex && alpha < 1 ? aimed_pdf(world, hop.side, vertex->patch, vertex->leg, vertex->cosine()) : 0;
  if (hop.aim.valid() && !(aimed > 0)) {  // in the plane of its target, which it passed by rounding
    hop.pdf = 0;
    return 0;
  }
  hop.aimed = alpha < 1;
  hop.off_list = vertex && alpha < 1 && aimed == 0;
  hop.pdf = hop.lobe * (alpha * hop.law_pdf + (1 - alpha) * aimed);
  if (path.trail.count > 0) {
    double const n = index_of(world, path.media.current());
    path.trail.link[0].forward = hop.pdf / (hop.cosine * n * n);
  }
  return hop.pdf > 0 ? hop.value / hop.pdf : 0;
}

// A direction towards a point drawn on one of the targets of the vertex; sets hop.aim.
STRAY_HD Vec3 aimed_direction(WorldView const& world, Vertex const& vertex, double choice, double u, double v,
                              Hop& hop) {
  Steering const& steering = world.steering;
  Target const& target = steering.targets[steering.draw(steering.sides[vertex.side()], choice)];
  Steering::Place const place = steering.place(target.patch, u);
  SurfaceId const aim = steering.strips[place.strip].surface;
  Vec3 const y =
      world.shapes.visit(world.surfaces[aim.value].shape, [&](auto const& s) { return sample_in_strip(s, place.u, v); })
          .point;
  Vec3 const span = y - vertex.point;
  hop.aim = aim;
  hop.aim_distance = length(span);
  return hop.aim_distance > 0 ? (1 / hop.aim_distance) * span : vertex.frame.e3;
}

// The scattered lobe; `choice` is uniform in (0, 1). hop.value stays 0 if no direction is found.
STRAY_HD Vec3 scattered_direction(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex,
                                  double choice) {
  Rng rng(seed, path.history, path.event, Stream::direction);
  double u = rng.uniform(), v = rng.uniform();
  if (path.event == 0) path.strata.deal(Dealt::direction, u, v);
  if (path.event == 1) path.strata.deal(Dealt::second_direction, u, v);
  Hop& hop = path.hop;
  hop.side = vertex.side();
  double const alpha = law_share(world, hop.side);
  if (choice < alpha) {
    BsdfSample const s = scatter_sample(world.laws, *vertex.optic, vertex.albedos, vertex.wi, choice / alpha, u, v,
                                        vertex.n_in, vertex.n_out);
    if (!(s.pdf > 0)) return {};
    hop.law_pdf = s.pdf;
    hop.value = s.value * std::fabs(s.wo.z);
    return s.wo;
  }
  Vec3 const out = aimed_direction(world, vertex, (choice - alpha) / (1 - alpha), u, v, hop);
  Vec3 const wo = vertex.frame.to_local(out);
  optics::ValueAndPdf const law =
      scatter_both(world.laws, *vertex.optic, vertex.albedos, vertex.wi, wo, vertex.n_in, vertex.n_out);
  hop.law_pdf = law.pdf;
  hop.value = law.value * std::fabs(wo.z);
  return wo;
}

// Phase of the interface, in turns (docs/theory/conventions.md): a stated power reflects with a quarter, so that a
// splitter without loss is unitary and the two ports of an interferometer are each other's complement.
STRAY_HD double interface_turns(WorldView const& world, Vertex const& vertex, bool through) {
  Amplitudes const a =
      specular_amplitudes(world.interfaces, *vertex.optic, vertex.wi.z, vertex.n_in, vertex.n_out, vertex.front);
  optics::Complex const field = through ? a.ts : a.rs;
  return turn_of(field.re, field.im);
}

// The specular way on one side of the vertex. `choice`, even from 0 to the share of that side, picks the order of a
// grating.
STRAY_HD SpecularWay specular_way(WorldView const& world, Vec3 travel, Vertex const& vertex, bool through,
                                  double choice) {
  if (vertex.optic->diffracts) return chosen_order(world, vertex, travel, through, choice);
  SpecularWay way;
  way.through = through;
  way.out = unit(vertex.frame.to_world(specular(vertex.wi)));
  if (!through) return way;
  way.out = travel;
  if (vertex.n_in != vertex.n_out) refracted(travel, vertex.frame.e3, vertex.n_in, vertex.n_out, way.out);
  if (vertex.smooth && dot(way.out, vertex.facet) >= 0) way.out = below(way.out, vertex.facet);
  return way;
}

// The state of polarisation behind a specular way. An order of a grating turns it like small facets that reflect or
// refract one direction into the other.
STRAY_HD Polarisation polarisation_after(WorldView const& world, Polarisation const& in, Vec3 travel,
                                         Vertex const& vertex, SpecularWay const& way) {
  if (way.order != 0) return scattered(in, travel, way.out, way.through, 0);
  Amplitudes const a =
      specular_amplitudes(world.interfaces, *vertex.optic, vertex.wi.z, vertex.n_in, vertex.n_out, vertex.front);
  return (way.through ? transmitted(in, travel, vertex.frame.e3, a) : reflected(in, travel, vertex.frame.e3, a)).state;
}

// Leaves the vertex by a specular way.
STRAY_HD void leave_specular(WorldView const& world, PathState& path, Vertex const& vertex, SpecularWay const& way) {
  if (way.through) path.media = vertex.after;
  if (world.polarised) path.polarisation = polarisation_after(world, path.polarisation, path.ray.dir, vertex, way);
  if (path.coherent)
    path.turned += way.order != 0 ? way.turns + (way.through ? 0 : 0.25) : interface_turns(world, vertex, way.through);
  path.ray.dir = way.out;
  path.hop.left_by = way.event();
}

// Sets ray, hop and route; false: no light leaves. `source`: the vertex lies in the main mode, whose specular
// reflection is not stray light, so only scattered light starts there. On entry path.ray.dir is the direction of
// arrival.
template <class Sink>
STRAY_HD bool scatter(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex, Sink& sink,
                      bool source = false) {
  double const reflect = source ? 0 : vertex.reflect, transmit = source ? 0 : vertex.transmit;
  double const kept = vertex.albedo + reflect + transmit;
  if (!(kept > 0)) return false;
  path.from = {vertex.surface, vertex.piece, vertex.contact};
  path.ray.origin = vertex.point;
  path.ray.t_max = infinity;
  path.media = vertex.before;
  Hop const arrived = path.hop;
  path.hop = {};
  path.hop.kept = kept;
  bool const dealt = source && path.stratum >= 0;
  double choice = dealt ? path.stratum : Rng(seed, path.history, path.event, Stream::lobe).uniform();
  if (path.event == 1) choice = path.strata.deal(Dealt::second_choice, choice);
  choice *= kept;
  if (choice < reflect + transmit) {
    bool const through = choice >= reflect;
    path.hop.value = through ? transmit : reflect;
    path.hop.lobe = path.hop.value / kept;
    SpecularWay const way = specular_way(world, path.ray.dir, vertex, through, through ? choice - reflect : choice);
    if (world.both_ends) pass_specular(world, path.trail, vertex, way, path.hop.lobe);
    leave_specular(world, path, vertex, way);
  } else {
    path.hop.left_by = Event::scatter;
    Vec3 const travel = path.ray.dir;
    if (world.both_ends) path.trail.start = start_of(world, path, vertex, arrived);
    path.coherent = false;
    path.hop.lobe = vertex.albedo / kept;
    path.hop.value = 0;
    Vec3 const wo = scattered_direction(world, seed, path, vertex, (choice - reflect - transmit) / vertex.albedo);
    if (!(path.hop.value > 0)) {
      sink.book(BalanceTerm::sampling, path.power * kept);
      return false;
    }
    Vec3 const out = unit(vertex.frame.to_world(wo));
    path.hop.cosine = vertex.smooth ? std::fabs(dot(out, vertex.facet)) : std::fabs(wo.z);
    if (wo.z < 0) path.media = vertex.after;
    if (world.both_ends) path.trail.add(link_at(world, path.trail, arrived, vertex, travel, out, wo.z < 0));
    if (world.polarised)
      path.polarisation = scattered(path.polarisation, path.ray.dir, out, wo.z < 0, vertex.optic->depolarise);
    path.hop.below_facet = vertex.beyond_facet(wo, out);
    path.ray.dir = out;
  }
  path.route = extended(path.route, world.surfaces[vertex.surface.value].group, path.hop.left_by);
  return true;
}

}  // namespace straytrace::trace
