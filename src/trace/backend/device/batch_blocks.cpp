// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "trace/backend/device/device_backend.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace {
namespace {

// `tail`: descending.
Moments moments_of(MomentSums const& sums, double const* tail = nullptr, std::uint32_t tails = 0) {
  Moments m;
  m.sum = sums.sum;
  m.sum2 = sums.sum2;
  m.sum3 = sums.sum3;
  m.sum4 = sums.sum4;
  m.largest = sums.largest;
  m.largest_history = sums.largest_history;
  m.scored = sums.scored;
  m.tail.assign(tail, tail + tails);
  m.close_block();
  return m;
}

MapSums& map_of(ReceiverSums& receiver, MapKind map) {
  switch (map) {
    case MapKind::angles:
      return receiver.angles;
    case MapKind::quadrants:
      return receiver.quadrants;
    default:
      return receiver.image;
  }
}

}  // namespace

BatchBlocks::BatchBlocks(World const& world, BatchSums sums) : world_(world), sums_(std::move(sums)) {}

template <class Row>
BatchBlocks::Range<Row> BatchBlocks::of_block(std::vector<Row> const& rows, std::uint32_t position) {
  auto const first = std::partition_point(rows.begin(), rows.end(), [&](Row const& r) { return r.block < position; });
  auto const last = std::partition_point(first, rows.end(), [&](Row const& r) { return r.block == position; });
  return {rows.data() + (first - rows.begin()), rows.data() + (last - rows.begin())};
}

void BatchBlocks::put_totals(std::uint32_t position, int replica, BlockSums& block) const {
  for (TotalRow const& row : of_block(sums_.routes, position)) {
    KeptRow const& kept = sums_.routes_kept[std::size_t(&row - sums_.routes.data())];
    ClassSums& route = block.classes[row.route];
    route.port = row.port;
    route.moments = moments_of(row.moments, sums_.route_tails.data() + row.first_tail, row.tails);
    route.replica_sum[replica] = route.moments.sum;
    route.kept.assign(sums_.kept.data() + kept.first, sums_.kept.data() + kept.first + kept.count);
    route.off_list = kept.off_list;
    route.threshold = kept.threshold;
  }
  for (TotalRow const& row : of_block(sums_.receivers, position))
    block.receivers[row.port - first_receiver_end].power =
        moments_of(row.moments, sums_.receiver_tails.data() + row.first_tail, row.tails);
}

void BatchBlocks::put_maps(std::uint32_t position, BlockSums& block) const {
  for (CellRow const& row : of_block(sums_.cells, position)) {
    ReceiverSums& receiver = block.receivers[row.receiver];
    if (row.map == MapKind::field) {
      FieldSums& field = receiver.fields[row.route];
      if (field.power.empty())
        field.power = field.real = field.imaginary = std::vector<double>(receiver.image.sum.size());
      field.power[row.cell] = row.power;
      field.real[row.cell] = row.real;
      field.imaginary[row.cell] = row.imaginary;
    } else {
      MapSums& map = map_of(receiver, row.map);
      map.sum[row.cell] = row.power;
      map.sum2[row.cell] = row.power * row.power;
    }
  }
}

BlockSums BatchBlocks::block(std::uint32_t position, std::uint64_t number) const {
  int const replica = int(number % replica_count);
  BlockSums block = BlockSink(world_.view(), world_.groups().size(), replica).finish();  // zeros, of the right sizes
  BlockRow const& row = sums_.blocks[position];
  block.histories = largest_block;
  block.bounces = block.rays = row.bounces;
  block.lost = row.lost;
  block.window_variance = row.window_variance;
  block.emitted = moments_of(row.column[0]);
  for (int f = 0; f < fate_count; ++f) block.ledger[f] = moments_of(row.column[1 + f]);
  block.absorbed.back() = moments_of(row.column[1 + fate_count]);
  for (GroupRow const& group : of_block(sums_.groups, position)) {
    block.arrived[group.group] = moments_of(group.arrived);
    block.absorbed[group.group] = moments_of(group.absorbed);
  }
  put_totals(position, replica, block);
  put_maps(position, block);
  return block;
}

}  // namespace straytrace
