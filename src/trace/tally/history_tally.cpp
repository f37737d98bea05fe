// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/history_tally.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace {

void HistoryTally::begin(std::uint64_t history) {
  history_ = history;
  bounces_ = lost_ = 0;
  emitted_ = in_media_ = window_variance_ = 0;
  for (double& column : ledger_) column = 0;
  totals_.clear();
  scores_.clear();
  arrivals_.clear();
  cells_.clear();
}

void HistoryTally::visit(PathState const& path, Vertex const& vertex) {
  ++bounces_;
  if (!(vertex.wi.z > 0) || !std::isfinite(path.power)) ++lost_;
  std::uint32_t const group = world_->surfaces[vertex.surface.value].group.value;
  for (Arrival& a : arrivals_)
    if (a.group == group) {
      a.power += path.power;
      return;
    }
  arrivals_.push_back({group, path.power, 0});
}

void HistoryTally::absorbed(GroupId group, double power) {
  if (!group.valid()) {
    in_media_ += power;
    return;
  }
  auto const at = std::find_if(arrivals_.rbegin(), arrivals_.rend(), [&](auto& a) { return a.group == group.value; });
  at->absorbed += power;
}

void HistoryTally::score(PathState const& path, Vertex const& vertex, std::uint32_t goal, std::uint32_t number,
                         Vertex const& y, double coupling) {
  Route const route = route_of(*world_, path, vertex, goal, number, y.surface);
  if (goal >= world_->lit.size)
    add_to_maps(path, goal - std::uint32_t(world_->lit.size), y, route.hash, by_itself(number), coupling);
  add(path, route, number, coupling);
}

void HistoryTally::score_lit(PathState const& path, std::uint32_t source, Vertex const& z, Chain const& chain,
                             std::uint32_t receiver, Vertex const& end, double power) {
  Route const route = route_lit(*world_, source, z, chain, receiver);
  add_to_maps(path, receiver, end, route.hash, false, power);
  add(path, route, number_lit(*world_, source, chain.hops, receiver), power);
}

void HistoryTally::score_through(PathState const& path, Vertex const& vertex, Vertex const& z, Chain const& chain,
                                 std::uint32_t receiver, Vertex const& end, double power) {
  Route const route = route_through(*world_, path, vertex, z, chain, receiver);
  add_to_maps(path, receiver, end, route.hash, false, power);
  add(path, route, number_through(*world_, receiver), power);
}

void HistoryTally::add(PathState const& path, Route const& route, std::uint32_t number, double coupling) {
  if (!std::isfinite(coupling)) {
    ++lost_;
    return;
  }
  bool known = false;
  for (Total& t : totals_)
    if (t.route == route.hash) {
      t.sum += coupling;
      known = true;
      break;
    }
  if (!known) totals_.push_back({route.hash, route.end, coupling});

  // Numbers of sub-paths from lit surfaces may be in the thousands: they have streams of their own.
  bool const many = number >= number_lit(*world_, 0, 0, 0);
  std::uint32_t const own = many ? number << 8 : 0;
  Rng rng(seed_, path.history, path.event, static_cast<Stream>(std::uint32_t(Stream::record) + own));
  double u = rng.uniform();
  for (std::uint32_t i = 0; !many && i < number; ++i) u = rng.uniform();
  scores_.push_back({route.hash, {path.history, path.event, number, coupling, coupling / u}, path.hop.off_list});
}

void HistoryTally::add_to_maps(PathState const& path, std::uint32_t receiver, Vertex const& y, std::uint64_t route,
                               bool by_itself, double power) {
  Receiver const& r = world_->receivers[receiver];
  Cells cells{
      route, receiver, r.pixel(y.point), r.angle_pixel(y.frame.to_world(-y.wi)), Receiver::outside, power, false, 0, 0};
  if (r.quadrants) cells.quadrant = r.quadrant(y.point);
  if (path.coherent && by_itself && cells.pixel != Receiver::outside) {
    double const length = path.path_length + (r.clear ? y.leg : 0);  // a plane is met before the leg is over
    double const turns = length / world_->wavelength + path.turned;
    SinCos const phase = sincos_turn(turns - std::floor(turns));
    cells.coherent = true;
    cells.real = power * phase.cos;
    cells.imaginary = power * phase.sin;
  }
  bool const any = cells.pixel != Receiver::outside || cells.angle_pixel != Receiver::outside || r.quadrants;
  if (any) cells_.push_back(cells);
}

}  // namespace straytrace
