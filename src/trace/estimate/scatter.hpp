// SPDX-License-Identifier: BSD-3-Clause
// The next direction of a path: lobe by its share of what leaves the vertex; within the scattered lobe from the mixture
// of scatter law and targets.
#pragma once

#include "base/rng.hpp"
#include "trace/estimate/mixture.hpp"

namespace straytrace {

// The scattered lobe; `choice` is uniform in (0, 1).
STRAY_HD Vec3 scattered_direction(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex,
                                  double choice) {
  Rng rng(seed, path.history, path.event, Stream::direction);
  double const u = rng.uniform(), v = rng.uniform();
  Hop& hop = path.hop;
  hop.side = vertex.side();
  double const alpha = hop.side == WorldView::none ? 1 : world.steering.sides[hop.side].alpha;
  Vec3 wo;
  if (choice < alpha) {
    BsdfSample const s = scatter_sample(world.laws, *vertex.optic, vertex.wi, choice / alpha, u, v);
    hop.law_pdf = s.pdf;
    wo = s.wo;
    if (!(s.pdf > 0)) return {};
  } else {
    Vec3 const out = aimed_direction(world, vertex, (choice - alpha) / (1 - alpha), u, v, hop);
    wo = vertex.frame.to_local(out);
    hop.law_pdf = scatter_pdf(world.laws, *vertex.optic, vertex.wi, wo);
  }
  hop.value = scatter_eval(world.laws, *vertex.optic, vertex.wi, wo) * std::fabs(wo.z);
  return wo;
}

// Sets ray, hop and route; false: nothing leaves. `source`: the vertex lies in the main mode, whose specular
// reflection is not stray light, so only scattered light starts there.
template <class Sink>
STRAY_HD bool scatter(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex, Sink& sink,
                      bool source = false) {
  double const reflect = source ? 0 : vertex.reflect, kept = vertex.albedo + reflect;
  if (!(kept > 0)) return false;
  GroupId const group = world.surfaces[vertex.surface.value].group;
  path.from = {vertex.surface, vertex.piece};
  path.ray.origin = vertex.point;
  path.ray.t_max = infinity;
  path.hop = {};
  path.hop.kept = kept;
  double const choice = Rng(seed, path.history, path.event, Stream::lobe).uniform() * kept;
  if (choice < reflect) {
    path.ray.dir = unit(vertex.frame.to_world(specular(vertex.wi)));
    path.hop.left_by = Event::reflect;
    path.hop.value = reflect;
    path.hop.lobe = reflect / kept;
    path.route = extended(path.route, group, Event::reflect);
    return true;
  }
  path.hop.left_by = source ? Event::emit : Event::scatter;
  path.hop.lobe = vertex.albedo / kept;
  path.hop.value = 0;
  Vec3 const wo = scattered_direction(world, seed, path, vertex, (choice - reflect) / vertex.albedo);
  if (!(path.hop.value > 0)) {
    sink.book(Fate::sampling, path.power * kept);
    return false;
  }
  path.ray.dir = unit(vertex.frame.to_world(wo));
  path.route = extended(path.route, group, Event::scatter);
  return true;
}

}  // namespace straytrace
