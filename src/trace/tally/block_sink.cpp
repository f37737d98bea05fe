// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/block_sink.hpp"

namespace straytrace::trace {

BlockSink::BlockSink(WorldView const& world, std::size_t groups, int replica)
    : replica_(replica), received_(world.receivers.size) {
  sums_.blocks = 1;
  sums_.arrived.resize(groups);
  sums_.absorbed.resize(groups + 1);
  for (std::size_t i = 0; i < world.receivers.size; ++i) {
    Receiver const& r = world.receivers[i];
    ReceiverSums sums;
    sums.image.sum.resize(r.map_size());
    sums.angles.sum.resize(std::size_t(r.angle_bins) * r.angle_bins);
    sums.quadrants.sum.resize(r.quadrants ? Receiver::quadrant_cells : 0);
    sums_.receivers.push_back(std::move(sums));
  }
}

ClassSums& BlockSink::sums_of(std::uint64_t route) {
  Found& found = found_[route % found_.size()];
  if (!found.sums || found.route != route) found = {route, &classes_[route]};
  return *found.sums;
}

void BlockSink::add_records(HistoryTally const& tally) {
  for (HistoryScore const& score : tally.scores()) {
    ClassSums& sums = sums_of(score.route);
    if (score.off_list) sums.off_list += score.address.coupling;
    if (score.address.priority <= sums.threshold) continue;
    sums.kept.push_back(score.address);
    if (sums.kept.size() >= 2 * records_per_class) drop_smallest(sums);
  }
}

void BlockSink::add_to_maps(HistoryCells const& cells) {
  ReceiverSums& sums = sums_.receivers[cells.receiver];
  if (cells.angle_pixel != Receiver::outside) sums.angles.sum[cells.angle_pixel] += cells.power;
  if (cells.quadrant != Receiver::outside) sums.quadrants.sum[cells.quadrant] += cells.power;
  if (cells.pixel == Receiver::outside) return;
  sums.image.sum[cells.pixel] += cells.power;
  if (!cells.coherent) return;
  FieldSums& field = sums.fields[cells.route];
  if (field.power.empty()) field.power = field.real = field.imaginary = std::vector<double>(sums.image.sum.size());
  field.power[cells.pixel] += cells.power;
  field.real[cells.pixel] += cells.real;
  field.imaginary[cells.pixel] += cells.imaginary;
}

void BlockSink::add(HistoryTally const& tally) {
  std::uint64_t const history = tally.history();
  ++sums_.histories;
  sums_.bounces += tally.bounces();
  sums_.rays += tally.bounces();
  sums_.lost += tally.lost();
  sums_.window_variance += tally.window_variance();
  add_records(tally);
  for (HistoryCells const& cells : tally.cells()) add_to_maps(cells);
  for (HistoryTotal const& t : tally.totals()) {
    ClassSums& sums = sums_of(t.route);
    sums.port = t.port;
    sums.moments.add_score(t.sum, history);
    if (t.port >= first_receiver_end) received_[t.port - first_receiver_end] += t.sum;
  }
  for (std::size_t i = 0; i < received_.size(); ++i) {
    sums_.receivers[i].power.add_score(received_[i], history);
    received_[i] = 0;
  }
  sums_.emitted.add(tally.power_emitted(), history);
  for (int f = 0; f < balance_term_count; ++f)
    sums_.energy_balance[f].add(tally.booked(static_cast<BalanceTerm>(f)), history);
  for (HistoryArrival const& a : tally.arrivals()) {
    sums_.arrived[a.group].add(a.power, history);
    sums_.absorbed[a.group].add(a.absorbed, history);
  }
  sums_.absorbed.back().add(tally.absorbed_in_media(), history);
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
  for (Moments& m : sums_.energy_balance) m.close_block();
  for (Moments& m : sums_.arrived) m.close_block();
  for (Moments& m : sums_.absorbed) m.close_block();
  return std::move(sums_);
}

}  // namespace straytrace::trace
