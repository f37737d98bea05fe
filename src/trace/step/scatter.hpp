// SPDX-License-Identifier: BSD-3-Clause
// The next direction of a path: lobe by its share of what leaves the vertex; within the scattered lobe from the mixture
// of scatter law and targets.
#pragma once

#include "base/math/rng.hpp"
#include "trace/step/mixture.hpp"

namespace straytrace {

// The scattered lobe; `choice` is uniform in (0, 1). hop.value stays 0 when no direction is found.
STRAY_HD Vec3 scattered_direction(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex,
                                  double choice) {
  Rng rng(seed, path.history, path.event, Stream::direction);
  double const u = rng.uniform(), v = rng.uniform();
  Hop& hop = path.hop;
  hop.side = vertex.side();
  double const alpha = law_share(world, hop.side);
  Vec3 wo;
  if (choice < alpha) {
    BsdfSample const s =
        scatter_sample(world.laws, *vertex.optic, vertex.wi, choice / alpha, u, v, vertex.n_in, vertex.n_out);
    hop.law_pdf = s.pdf;
    wo = s.wo;
    if (!(s.pdf > 0)) return {};
  } else {
    Vec3 const out = aimed_direction(world, vertex, (choice - alpha) / (1 - alpha), u, v, hop);
    wo = vertex.frame.to_local(out);
    hop.law_pdf = scatter_pdf(world.laws, *vertex.optic, vertex.wi, wo, vertex.n_in, vertex.n_out);
  }
  hop.value = scatter_eval(world.laws, *vertex.optic, vertex.wi, wo, vertex.n_in, vertex.n_out) * std::fabs(wo.z);
  return wo;
}

// Density per area with which the walk reached the vertex: by a scattered hop, or straight from the plane of a free
// beam. 0: it has none.
STRAY_HD double reached_density(WorldView const& world, PathState const& path, Vertex const& vertex) {
  if (!path.coherent || path.hop.left_by != Event::emit) return per_area(path.hop.pdf, vertex.leg, vertex.wi.z);
  return world.lit[path.source].passing(vertex.point).irradiance * vertex.wi.z / double(world.emitters.size);
}

// Phase of the interface, in turns (docs/theory/conventions.md): a stated power reflects with a quarter, so that a
// splitter without loss is unitary and the two ports of an interferometer are each other's complement.
STRAY_HD double interface_turns(WorldView const& world, Vertex const& vertex, bool through) {
  Amplitudes const a =
      specular_amplitudes(world.interfaces, *vertex.optic, vertex.wi.z, vertex.n_in, vertex.n_out, vertex.front);
  Complex const field = through ? a.ts : a.rs;
  return turn_of(field.re, field.im);
}

// A specular lobe: its direction, and the state of polarisation after it.
STRAY_HD void leave_specular(WorldView const& world, PathState& path, Vertex const& vertex, bool through) {
  Vec3 const travel = path.ray.dir;
  Vec3 out = unit(vertex.frame.to_world(specular(vertex.wi)));
  if (through) {
    out = travel;
    if (vertex.n_in != vertex.n_out) refracted(travel, vertex.frame.e3, vertex.n_in, vertex.n_out, out);
    path.media = vertex.after;
  }
  if (world.polarised) {
    Amplitudes const a =
        specular_amplitudes(world.interfaces, *vertex.optic, vertex.wi.z, vertex.n_in, vertex.n_out, vertex.front);
    path.polarisation = (through ? transmitted(path.polarisation, travel, vertex.frame.e3, a)
                                 : reflected(path.polarisation, travel, vertex.frame.e3, a))
                            .state;
  }
  if (path.coherent) path.turned += interface_turns(world, vertex, through);
  path.ray.dir = out;
  path.hop.left_by = through ? Event::transmit : Event::reflect;
}

// Sets ray, hop and route; false: nothing leaves. `source`: the vertex lies in the main mode, whose specular
// reflection is not stray light, so only scattered light starts there. path.ray.dir is the direction of arrival.
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
  double const reached = source ? path.reached_pdf : reached_density(world, path, vertex);
  path.hop = {};
  path.hop.kept = kept;
  bool const dealt = source && path.stratum >= 0;
  double const choice = (dealt ? path.stratum : Rng(seed, path.history, path.event, Stream::lobe).uniform()) * kept;
  if (choice < reflect + transmit) {
    bool const through = choice >= reflect;
    path.hop.value = through ? transmit : reflect;
    path.hop.lobe = path.hop.value / kept;
    leave_specular(world, path, vertex, through);
  } else {
    path.hop.left_by = Event::scatter;
    path.coherent = false;
    path.reached_pdf = reached;
    path.hop.lobe = vertex.albedo / kept;
    path.hop.value = 0;
    Vec3 const wo = scattered_direction(world, seed, path, vertex, (choice - reflect - transmit) / vertex.albedo);
    if (!(path.hop.value > 0)) {
      sink.book(BalanceTerm::sampling, path.power * kept);
      return false;
    }
    Vec3 const out = unit(vertex.frame.to_world(wo));
    path.hop.cosine = std::fabs(wo.z);
    if (wo.z < 0) path.media = vertex.after;
    if (world.polarised)
      path.polarisation = scattered(path.polarisation, path.ray.dir, out, wo.z < 0, vertex.optic->depolarise);
    path.ray.dir = out;
  }
  path.route = extended(path.route, world.surfaces[vertex.surface.value].group, path.hop.left_by);
  return true;
}

}  // namespace straytrace
