// SPDX-License-Identifier: BSD-3-Clause
// The next direction of a path: lobe by its share of what leaves the vertex, direction by the scatter law.
#pragma once

#include "base/rng.hpp"
#include "trace/history/path.hpp"

namespace straytrace {

// Sets ray, power, hop and route; false: nothing leaves. `source`: the vertex lies in the main mode, whose specular
// reflection is not stray light, so only scattered light starts there.
template <class Sink>
STRAY_HD bool scatter(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex, Sink& sink,
                      bool source = false) {
  double const reflect = source ? 0 : vertex.optic->reflect, kept = vertex.albedo + reflect;
  if (!(kept > 0)) return false;
  GroupId const group = world.surfaces[vertex.surface.value].group;
  path.from = {vertex.surface, vertex.piece};
  path.ray.origin = vertex.point;
  path.ray.t_max = infinity;
  double choice = Rng(seed, path.history, path.event, Stream::lobe).uniform() * kept;
  if (choice < reflect) {
    path.ray.dir = unit(vertex.frame.to_world(specular(vertex.wi)));
    path.power *= kept;  // reflectance over the probability of its lobe
    path.hop.pdf = 0;
    path.route = extended(path.route, group, Event::reflect);
    return true;
  }
  choice = (choice - reflect) / vertex.albedo;
  Rng rng(seed, path.history, path.event, Stream::direction);
  double const u = rng.uniform(), v = rng.uniform();
  BsdfSample const s = scatter_sample(world.laws, *vertex.optic, vertex.wi, choice, u, v);
  double const value = s.pdf > 0 ? scatter_eval(world.laws, *vertex.optic, vertex.wi, s.wo) * s.wo.z : 0;
  double const weight = s.pdf > 0 ? value / s.pdf * (kept / vertex.albedo) : 0;
  sink.book(Fate::sampling, path.power * (kept - weight));  // zero on average: that is a test
  path.power *= weight;
  path.hop.pdf = s.pdf * vertex.albedo / kept;
  path.ray.dir = unit(vertex.frame.to_world(s.wo));
  path.route = extended(path.route, group, Event::scatter);
  return path.power > 0;
}

}  // namespace straytrace
