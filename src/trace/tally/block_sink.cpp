// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/block_sink.hpp"

#include <algorithm>
#include <cmath>

#include "trace/tally/route.hpp"

namespace straytrace {

BlockSink::BlockSink(WorldView const& world, std::uint64_t seed, std::size_t groups, int replica)
    : world_(world), seed_(seed), replica_(replica), received_(world.receivers.size) {
  sums_.blocks = 1;
  sums_.arrived.resize(groups);
  sums_.absorbed.resize(groups + 1);
  for (std::size_t i = 0; i < world.receivers.size; ++i) {
    Receiver const& r = world.receivers[i];
    ReceiverSums sums;
    sums.image.sum.resize(std::size_t(r.columns) * r.rows);
    sums.angles.sum.resize(std::size_t(r.angle_bins) * r.angle_bins);
    sums.quadrants.sum.resize(r.quadrants ? Receiver::quadrant_cells : 0);
    sums_.receivers.push_back(std::move(sums));
  }
}

void BlockSink::begin(std::uint64_t history) {
  history_ = history;
  emitted_ = in_media_ = 0;
  for (double& column : ledger_) column = 0;
  totals_.clear();
  arrivals_.clear();
}

void BlockSink::visit(PathState const& path, Vertex const& vertex) {
  ++sums_.bounces;
  ++sums_.rays;
  if (!(vertex.wi.z > 0) || !std::isfinite(path.power)) ++sums_.lost;
  std::uint32_t const group = world_.surfaces[vertex.surface.value].group.value;
  for (Arrival& a : arrivals_)
    if (a.group == group) {
      a.power += path.power;
      return;
    }
  arrivals_.push_back({group, path.power, 0});
}

void BlockSink::absorbed(GroupId group, double power) {
  if (!group.valid()) {
    in_media_ += power;
    return;
  }
  auto const at = std::find_if(arrivals_.rbegin(), arrivals_.rend(), [&](auto& a) { return a.group == group.value; });
  at->absorbed += power;
}

void BlockSink::score(PathState const& path, Vertex const& vertex, std::uint32_t goal, std::uint32_t number,
                      Vertex const& y, double coupling) {
  Route const route = route_of(world_, path, vertex, goal, number, y.surface);
  if (goal >= world_.lit.size)
    add_to_maps(path, goal - std::uint32_t(world_.lit.size), y, route.hash, by_itself(number), coupling);
  add(path, route, number, coupling);
}

void BlockSink::score_lit(PathState const& path, std::uint32_t source, Vertex const& z, Chain const& chain,
                          std::uint32_t receiver, Vertex const& end, double power) {
  Route const route = route_lit(world_, source, z, chain, receiver);
  add_to_maps(path, receiver, end, route.hash, false, power);
  add(path, route, number_lit(world_, source, chain.hops, receiver), power);
}

void BlockSink::score_through(PathState const& path, Vertex const& vertex, Vertex const& z, Chain const& chain,
                              std::uint32_t receiver, Vertex const& end, double power) {
  Route const route = route_through(world_, path, vertex, z, chain, receiver);
  add_to_maps(path, receiver, end, route.hash, false, power);
  add(path, route, number_through(world_, receiver), power);
}

void BlockSink::add(PathState const& path, Route const& named, std::uint32_t number, double coupling) {
  if (!std::isfinite(coupling)) {
    ++sums_.lost;
    return;
  }
  std::uint64_t const route = named.hash;
  std::uint32_t const port = named.end;
  bool known = false;
  for (Total& t : totals_)
    if (t.route == route) {
      t.sum += coupling;
      known = true;
      break;
    }
  if (!known) totals_.push_back({route, port, coupling});

  // Numbers of sub-paths from lit surfaces may be in the thousands: they have streams of their own.
  bool const many = number >= number_lit(world_, 0, 0, 0);
  std::uint32_t const own = many ? number << 8 : 0;
  Rng rng(seed_, path.history, path.event, static_cast<Stream>(std::uint32_t(Stream::record) + own));
  double u = rng.uniform();
  for (std::uint32_t i = 0; !many && i < number; ++i) u = rng.uniform();
  ClassSums& sums = classes_[route];
  if (path.hop.off_list) sums.off_list += coupling;
  double const priority = coupling / u;
  if (priority <= sums.threshold) return;
  sums.kept.push_back({path.history, path.event, number, coupling, priority});
  if (sums.kept.size() >= 4 * records_per_class) keep_largest(sums);
}

void BlockSink::add_to_maps(PathState const& path, std::uint32_t receiver, Vertex const& y, std::uint64_t route,
                            bool by_itself, double power) {
  Receiver const& r = world_.receivers[receiver];
  ReceiverSums& sums = sums_.receivers[receiver];
  Vec3 const travel = y.frame.to_world(-y.wi);
  if (std::uint32_t const bin = r.angle_pixel(travel); bin != Receiver::outside) sums.angles.sum[bin] += power;
  if (r.quadrants) sums.quadrants.sum[r.quadrant(y.point)] += power;
  std::uint32_t const pixel = r.pixel(y.point);
  if (pixel == Receiver::outside) return;
  sums.image.sum[pixel] += power;
  if (!path.coherent || !by_itself) return;
  FieldSums& field = sums.fields[route];
  if (field.power.empty()) field.power = field.real = field.imaginary = std::vector<double>(sums.image.sum.size());
  double const length = path.path_length + (r.clear ? y.leg : 0);  // a plane is met before the leg is over
  double const turns = length / world_.wavelength;
  SinCos const phase = sincos_turn(turns - std::floor(turns));
  field.power[pixel] += power;
  field.real[pixel] += power * phase.cos;
  field.imaginary[pixel] += power * phase.sin;
}

void BlockSink::end() {
  ++sums_.histories;
  for (Total const& t : totals_) {
    ClassSums& sums = classes_[t.route];
    sums.port = t.port;
    sums.moments.add_score(t.sum, history_);
    if (t.port >= first_receiver_end) received_[t.port - first_receiver_end] += t.sum;
  }
  for (std::size_t i = 0; i < received_.size(); ++i) {
    sums_.receivers[i].power.add_score(received_[i], history_);
    received_[i] = 0;
  }
  sums_.emitted.add(emitted_, history_);
  for (int f = 0; f < fate_count; ++f) sums_.ledger[f].add(ledger_[f], history_);
  for (Arrival const& a : arrivals_) {
    sums_.arrived[a.group].add(a.power, history_);
    sums_.absorbed[a.group].add(a.absorbed, history_);
  }
  sums_.absorbed.back().add(in_media_, history_);
}

BlockSums BlockSink::finish() {
  for (auto& [route, sums] : classes_) {
    keep_largest(sums);
    sums.replica_sum[replica_] = sums.moments.sum;
    sums.moments.close_block();
    sums_.classes.emplace(route, std::move(sums));
  }
  for (ReceiverSums& r : sums_.receivers) {
    r.power.close_block();
    for (MapSums* map : {&r.image, &r.angles, &r.quadrants}) {
      map->sum2.reserve(map->sum.size());
      for (double const x : map->sum) map->sum2.push_back(x * x);
    }
  }
  sums_.emitted.close_block();
  for (Moments& m : sums_.ledger) m.close_block();
  for (Moments& m : sums_.arrived) m.close_block();
  for (Moments& m : sums_.absorbed) m.close_block();
  return std::move(sums_);
}

}  // namespace straytrace
