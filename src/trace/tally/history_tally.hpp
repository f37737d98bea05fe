// SPDX-License-Identifier: BSD-3-Clause
// The scores of one history. Paths of many histories are in flight at once; a block adds their tallies in the order of
// histories. On a device the lists have a fixed capacity (trace/backend/device).
#pragma once

#include <vector>

#include "trace/result.hpp"
#include "trace/step/path.hpp"
#include "trace/step/sub_path.hpp"

namespace straytrace::trace {

// The route of a score: how many vertices it has, where it ends, and its hash.
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

STRAY_HD std::uint32_t end_of(WorldView const& world, std::uint32_t goal) {
  return is_receiver(world, goal) ? first_receiver_end + place_of(world, goal) : world.lit[goal].port.value;
}

// `at`: the vertex scored from; `y`: the point on the goal.
STRAY_HD Route route_of(WorldView const& world, PathState const& path, Vertex const& at, std::uint32_t goal,
                        std::uint32_t number, SurfaceId y) {
  bool const receiver = is_receiver(world, goal);
  Route route;
  route.end = end_of(world, goal);
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

// Numbers of the scores by surfaces in light below the crossover angle: after those of all goals.
STRAY_HD std::uint32_t number_halo(WorldView const& world, std::uint32_t source, bool connected) {
  std::uint32_t const place = goal_count(world) + source;
  return connected ? connection_number(place) : arrival_number(place);
}
// Numbers of the scores by sub-paths: after those, first those of connections to their vertices.
STRAY_HD std::uint32_t first_of_sub_paths(WorldView const& world) {
  return connection_number(goal_count(world) + std::uint32_t(world.halo.sources.size));
}
STRAY_HD std::uint32_t number_through(WorldView const& world, std::uint32_t ends, std::uint32_t goal) {
  return first_of_sub_paths(world) + 2 * (place_of(world, goal) * most_ends + ends);
}
// Of a sub-path that meets a surface lit by the beam `source`, by hops.
STRAY_HD std::uint32_t number_lit(WorldView const& world, std::uint32_t source, std::uint32_t hops,
                                  std::uint32_t goal) {
  constexpr std::uint32_t most_hops = most_ends * (most_specular_hops + 2);
  std::uint32_t const place = (place_of(world, goal) * std::uint32_t(world.lit.size) + source) * most_hops + hops;
  return first_of_sub_paths(world) + 2 * (goal_count(world) * most_ends + place);
}
// Route of light that rejoins the mode by the surface at y in the light of a source; x: the vertex before, or y itself.
STRAY_HD Route route_halo(WorldView const& world, PathState const& path, Vertex const& x, Vertex const& y,
                          std::uint32_t source, bool connected) {
  Footprint const& mode = world.lit[world.halo.sources[source].footprint];
  Route route;
  route.end = mode.port.value;
  route.vertices = path.order + (connected ? 3 : 2);
  route.other = route.vertices > world.limits.route_vertices;
  std::uint64_t name = path.route;
  if (connected) name = extended(name, world.surfaces[x.surface.value].group, Event::scatter);
  name = extended(name, world.surfaces[y.surface.value].group, Event::scatter);
  name = extended(name, world.surfaces[mode.surface.value].group, Event::couple);
  route.hash = hash_of_ends(world.lit[path.source].beam, route.other ? 0 : name, route.end);
  return route;
}
// `name`: of the vertices up to z; `vertices`: their number.
STRAY_HD Route route_behind(WorldView const& world, std::uint64_t name, std::uint32_t vertices, std::uint32_t source,
                            Chain const& chain, std::uint32_t goal) {
  Route route;
  route.end = end_of(world, goal);
  route.vertices = vertices + chain.hops + 1;
  route.other = route.vertices > world.limits.route_vertices || chain.hops > Chain::most_names;
  for (std::uint32_t i = route.other ? 0 : chain.hops; i-- > 0;)
    name = extended(name, {std::uint32_t(chain.name[i] >> 8)}, static_cast<Event>(chain.name[i] & 0xff));
  name = extended(name, world.surfaces[surface_of(world, goal).value].group,
                  is_receiver(world, goal) ? Event::receive : Event::couple);
  route.hash = hash_of_ends(world.lit[source].beam, route.other ? 0 : name, route.end);
  return route;
}
// Route of x -> z -> goal.
STRAY_HD Route route_through(WorldView const& world, PathState const& path, Vertex const& x, Vertex const& z,
                             Chain const& chain, std::uint32_t goal) {
  std::uint64_t name = extended(path.route, world.surfaces[x.surface.value].group, Event::scatter);
  name = extended(name, world.surfaces[z.surface.value].group, Event::scatter);
  return route_behind(world, name, path.order + 2, path.source, chain, goal);
}
// Route of z -> goal, for light of the beam `source` on z.
STRAY_HD Route route_lit(WorldView const& world, std::uint32_t source, Vertex const& z, Chain const& chain,
                         std::uint32_t goal) {
  Footprint const& beam = world.lit[source];
  std::uint64_t const start = beam.free ? extended(0, beam.origin, Event::emit) : 0;
  std::uint64_t const name = extended(start, world.surfaces[z.surface.value].group, Event::scatter);
  return route_behind(world, name, beam.free ? 2 : 1, source, chain, goal);
}

struct HistoryTotal {  // of all scores of one route
  std::uint64_t route;
  std::uint32_t port;
  double sum;
};
struct HistoryScore {
  std::uint64_t route;
  ScoreAddress address;
  bool off_list;  // the last hop met no listed target
};
struct HistoryArrival {
  std::uint32_t group;
  double power, absorbed;
};
struct HistoryCells {  // of the maps of a receiver; Receiver::outside: none
  std::uint64_t route;
  std::uint32_t receiver, pixel, angle_pixel, quadrant;
  double power;
  bool coherent;
  double real, imaginary;  // power times cos and sin of its phase
};

template <template <class> class List>
struct TallyLists {
  List<HistoryTotal> totals;
  List<HistoryScore> scores;
  List<HistoryArrival> arrivals;
  List<HistoryCells> cells;
};

// `List` offers push_back, clear, begin and end.
template <template <class> class List>
class BasicTally {
 public:
  STRAY_HD BasicTally(WorldView const& world, std::uint64_t seed, TallyLists<List> lists = {})
      : world_(&world), seed_(seed), lists_(static_cast<TallyLists<List>&&>(lists)) {}
  STRAY_HD void begin(std::uint64_t history);

  // The sink of trace/step/step.hpp.
  STRAY_HD void emitted(PathState const& path, Vertex const&) { emitted_ = path.emitted; }
  STRAY_HD void visit(PathState const& path, Vertex const& vertex);
  STRAY_HD void score(PathState const& path, Vertex const& vertex, std::uint32_t goal, std::uint32_t number,
                      Vertex const& y, double coupling);
  STRAY_HD void score_halo(PathState const& path, Vertex const& x, Vertex const& y, std::uint32_t source,
                           bool connected, double coupling) {
    add(path, route_halo(*world_, path, x, y, source, connected), number_halo(*world_, source, connected), coupling);
  }
  STRAY_HD void score_through(PathState const& path, Vertex const& vertex, Vertex const& z, Chain const& chain,
                              std::uint32_t goal, Vertex const& end, double power);
  STRAY_HD void score_lit(PathState const& path, std::uint32_t source, Vertex const& z, Chain const& chain,
                          std::uint32_t goal, Vertex const& end, double power);
  STRAY_HD void roulette_variance(double variance) { window_variance_ += variance; }
  STRAY_HD void absorbed(GroupId group, double power);  // after the visit to the group; no group: in a medium
  STRAY_HD void book(BalanceTerm balance_term, double power) {
    energy_balance_[static_cast<int>(balance_term)] += power;
  }

  STRAY_HD std::uint64_t history() const { return history_; }
  STRAY_HD std::uint64_t bounces() const { return bounces_; }
  STRAY_HD std::uint64_t lost() const { return lost_; }
  STRAY_HD double power_emitted() const { return emitted_; }
  STRAY_HD double booked(BalanceTerm balance_term) const { return energy_balance_[static_cast<int>(balance_term)]; }
  STRAY_HD double absorbed_in_media() const { return in_media_; }
  STRAY_HD double window_variance() const { return window_variance_; }
  STRAY_HD List<HistoryTotal> const& totals() const { return lists_.totals; }
  STRAY_HD List<HistoryScore> const& scores() const { return lists_.scores; }
  STRAY_HD List<HistoryArrival> const& arrivals() const { return lists_.arrivals; }
  STRAY_HD List<HistoryCells> const& cells() const { return lists_.cells; }

 private:
  STRAY_HD void add(PathState const& path, Route const& route, std::uint32_t number, double coupling);
  STRAY_HD void add_to_maps(PathState const& path, std::uint32_t goal, Vertex const& y, std::uint64_t route, bool alone,
                            double power);

  WorldView const* world_;
  std::uint64_t seed_, history_ = 0, bounces_ = 0, lost_ = 0;
  double emitted_ = 0, in_media_ = 0, window_variance_ = 0;
  double energy_balance_[balance_term_count] = {};
  TallyLists<List> lists_;
};

template <class T>
using GrowingList = std::vector<T>;
using HistoryTally = BasicTally<GrowingList>;

template <template <class> class List>
STRAY_HD void BasicTally<List>::begin(std::uint64_t history) {
  history_ = history;
  bounces_ = lost_ = 0;
  emitted_ = in_media_ = window_variance_ = 0;
  for (double& column : energy_balance_) column = 0;
  lists_.totals.clear();
  lists_.scores.clear();
  lists_.arrivals.clear();
  lists_.cells.clear();
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::visit(PathState const& path, Vertex const& vertex) {
  ++bounces_;
  if (!(vertex.wi.z > 0) || !std::isfinite(path.power)) ++lost_;
  std::uint32_t const group = world_->surfaces[vertex.surface.value].group.value;
  for (HistoryArrival& a : lists_.arrivals)
    if (a.group == group) {
      a.power += path.power;
      return;
    }
  lists_.arrivals.push_back({group, path.power, 0});
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::absorbed(GroupId group, double power) {
  if (!group.valid()) {
    in_media_ += power;
    return;
  }
  for (HistoryArrival& a : lists_.arrivals)
    if (a.group == group.value) a.absorbed += power;
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::score(PathState const& path, Vertex const& vertex, std::uint32_t goal,
                                      std::uint32_t number, Vertex const& y, double coupling) {
  Route const route = route_of(*world_, path, vertex, goal, number, y.surface);
  if (is_receiver(*world_, goal)) add_to_maps(path, goal, y, route.hash, is_hit(number), coupling);
  add(path, route, number, coupling);
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::score_lit(PathState const& path, std::uint32_t source, Vertex const& z,
                                          Chain const& chain, std::uint32_t goal, Vertex const& end, double power) {
  Route const route = route_lit(*world_, source, z, chain, goal);
  if (is_receiver(*world_, goal)) add_to_maps(path, goal, end, route.hash, false, power);
  add(path, route, number_lit(*world_, source, chain.hops, goal), power);
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::score_through(PathState const& path, Vertex const& vertex, Vertex const& z,
                                              Chain const& chain, std::uint32_t goal, Vertex const& end, double power) {
  Route const route = route_through(*world_, path, vertex, z, chain, goal);
  if (is_receiver(*world_, goal)) add_to_maps(path, goal, end, route.hash, false, power);
  add(path, route, number_through(*world_, chain.ends, goal), power);
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::add(PathState const& path, Route const& route, std::uint32_t number, double coupling) {
  if (!std::isfinite(coupling)) {
    ++lost_;
    return;
  }
  bool known = false;
  for (HistoryTotal& t : lists_.totals)
    if (t.route == route.hash) {
      t.sum += coupling;
      known = true;
      break;
    }
  if (!known) lists_.totals.push_back({route.hash, route.end, coupling});

  // Numbers of sub-paths may be in the thousands: they have streams of their own.
  bool const many = number >= first_of_sub_paths(*world_);
  std::uint32_t const own = many ? number << 8 : 0;
  Rng rng(seed_, path.history, path.event, static_cast<Stream>(std::uint32_t(Stream::record) + own));
  if (!many) rng.skip(number);
  double const u = rng.uniform();
  lists_.scores.push_back({route.hash, {path.history, path.event, number, coupling, coupling / u}, path.hop.off_list});
}

template <template <class> class List>
STRAY_HD void BasicTally<List>::add_to_maps(PathState const& path, std::uint32_t goal, Vertex const& y,
                                            std::uint64_t route, bool alone, double power) {
  Receiver const& r = receiver_of(*world_, goal);
  std::uint32_t const out = Receiver::outside;
  HistoryCells cells{
      route, place_of(*world_, goal), r.pixel(y.point), r.angle_pixel(y.frame.to_world(-y.wi)), out, power, false, 0,
      0};
  if (r.quadrants) cells.quadrant = r.quadrant(y.point);
  if (path.coherent && alone && cells.pixel != out) {
    double const length = path.path_length + (r.clear ? y.leg : 0);  // a plane is met before the leg is over
    double const turns = length / world_->wavelength + path.turned;
    SinCos const phase = sincos_turn(turns - std::floor(turns));
    cells.coherent = true;
    cells.real = power * phase.cos;
    cells.imaginary = power * phase.sin;
  }
  bool const any = cells.pixel != out || cells.angle_pixel != out || r.quadrants;
  if (any) lists_.cells.push_back(cells);
}

}  // namespace straytrace::trace
