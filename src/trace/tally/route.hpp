// SPDX-License-Identifier: BSD-3-Clause
// The route of a score: how many vertices it has, where it ends, and its hash.
#pragma once

#include "trace/step/specular_connection.hpp"

namespace straytrace {

struct Route {
  std::uint64_t hash = 0;
  std::uint32_t vertices = 0;
  std::uint32_t end = 0;  // port, or receiver + first_receiver_end
  bool other = false;     // longer than the limit: summed in one class per end and source beam
};

// C_rev depends on the beams at the two ends, so paths of different source beams are never one class.
STRAY_HD std::uint64_t hash_of_ends(std::uint32_t beam, std::uint64_t name, std::uint32_t end) {
  return mixed(mixed(name + beam + 1) + (std::uint64_t(end) + 1) * 0xd1342543de82ef95ull);
}

// `at`: the vertex scored from; `y`: the point on the goal.
STRAY_HD Route route_of(WorldView const& world, PathState const& path, Vertex const& at, std::uint32_t goal,
                        std::uint32_t number, SurfaceId y) {
  bool const receiver = goal >= world.lit.size;
  Route route;
  route.end = receiver ? first_receiver_end + (goal - std::uint32_t(world.lit.size)) : world.lit[goal].port.value;
  std::uint64_t name = path.route;
  route.vertices = path.order + 1;
  bool const plane = receiver && is_hit(number) && world.surfaces[y.value].clear;  // met on the way
  if (!is_hit(number)) name = extended(name, world.surfaces[at.surface.value].group, Event::scatter);
  if (!is_hit(number) || plane) ++route.vertices;
  route.other = route.vertices > world.limits.route_vertices;
  name = route.other ? 0 : extended(name, world.surfaces[y.value].group, receiver ? Event::receive : Event::couple);
  route.hash = hash_of_ends(world.lit[path.source].beam, name, route.end);
  return route;
}

// Number of the score that a sub-path behind glass makes: goals after all others.
STRAY_HD std::uint32_t number_through(WorldView const& world, std::uint32_t receiver) {
  return connection_number(std::uint32_t(world.lit.size + world.receivers.size) + receiver);
}
// And of the one that starts on a surface lit by the beam `source`: numbers beyond all others, counted by hops.
STRAY_HD std::uint32_t number_lit(WorldView const& world, std::uint32_t source, std::uint32_t hops,
                                  std::uint32_t receiver) {
  std::uint32_t const place = (receiver * std::uint32_t(world.lit.size) + source) * (most_specular_hops + 1) + hops;
  return connection_number(std::uint32_t(world.lit.size + 2 * world.receivers.size) + place);
}
// `name`: of the vertices up to z; `vertices`: their number.
STRAY_HD Route route_behind(WorldView const& world, std::uint64_t name, std::uint32_t vertices, std::uint32_t source,
                            Chain const& chain, std::uint32_t receiver) {
  Route route;
  route.end = first_receiver_end + receiver;
  route.vertices = vertices + chain.hops + 1;
  route.other = route.vertices > world.limits.route_vertices;
  for (std::uint32_t i = chain.hops; i-- > 0;)
    name = extended(name, {std::uint32_t(chain.name[i] >> 8)}, static_cast<Event>(chain.name[i] & 0xff));
  name = extended(name, world.surfaces[world.receivers[receiver].surface.value].group, Event::receive);
  route.hash = hash_of_ends(world.lit[source].beam, route.other ? 0 : name, route.end);
  return route;
}
// Route of x -> z -> glass -> receiver.
STRAY_HD Route route_through(WorldView const& world, PathState const& path, Vertex const& x, Vertex const& z,
                             Chain const& chain, std::uint32_t receiver) {
  std::uint64_t name = extended(path.route, world.surfaces[x.surface.value].group, Event::scatter);
  name = extended(name, world.surfaces[z.surface.value].group, Event::scatter);
  return route_behind(world, name, path.order + 2, path.source, chain, receiver);
}
// Route of z -> glass -> receiver, for light of the beam `source` on z.
STRAY_HD Route route_lit(WorldView const& world, std::uint32_t source, Vertex const& z, Chain const& chain,
                         std::uint32_t receiver) {
  Footprint const& beam = world.lit[source];
  std::uint64_t const start = beam.free ? extended(0, beam.origin, Event::emit) : 0;
  std::uint64_t const name = extended(start, world.surfaces[z.surface.value].group, Event::scatter);
  return route_behind(world, name, beam.free ? 2 : 1, source, chain, receiver);
}

}  // namespace straytrace
