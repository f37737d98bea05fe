// SPDX-License-Identifier: BSD-3-Clause
// What a device writes down while it traces, and the sums it makes of it. Plain numbers: they are copied as they are.
#pragma once

#include <vector>

#include "trace/tally/history_tally.hpp"

namespace straytrace {

// Which histories a batch holds: whole blocks, any of them. Within the batch they are numbered from 0.
struct BatchHistories {
  std::uint64_t const* blocks = nullptr;
  STRAY_HD std::uint64_t operator()(std::uint32_t number) const {
    return blocks[number / largest_block] * largest_block + number % largest_block;
  }
};

// `history`: its number in the batch; `place` counts what one history wrote.
constexpr std::uint32_t no_history = 0xffffffffu;  // a place that was reserved and not used
template <class T>
struct Recorded {
  std::uint32_t history = no_history, place = 0;
  T what;
};

constexpr int batch_columns = 2 + balance_term_count;  // emitted, the terms of the energy balance, absorbed in media
struct HistoryRecord {
  double column[batch_columns];
  double window_variance;
  std::uint64_t bounces, lost;
  std::uint32_t again;  // it did not fit: the host has to run it; bits of what was short
};

// Of what there was too little: bit i for list i of TallyLists, bit 4 + i for the list that all histories share.
constexpr int shared_list = 4;

template <template <class> class List>
STRAY_HD HistoryRecord record_of(BasicTally<List> const& tally) {
  HistoryRecord r{};
  r.column[0] = tally.power_emitted();
  for (int f = 0; f < balance_term_count; ++f) r.column[1 + f] = tally.booked(static_cast<BalanceTerm>(f));
  r.column[1 + balance_term_count] = tally.absorbed_in_media();
  r.window_variance = tally.window_variance();
  r.bounces = tally.bounces();
  r.lost = tally.lost();
  return r;
}

// Moments without their tail.
struct MomentSums {
  double sum = 0, sum2 = 0, sum3 = 0, sum4 = 0, largest = 0;
  std::uint64_t largest_history = 0, scored = 0;
};
struct BlockRow {
  MomentSums column[batch_columns];
  double window_variance;
  std::uint64_t bounces, lost;
};
// Of one route, or of one receiver (`route`: its end).
struct TotalRow {
  std::uint64_t route;
  std::uint32_t block, port;
  MomentSums moments;
  std::uint32_t first_tail, tails;  // in BatchSums::tails, descending
};
struct KeptRow {  // of the same route as the total row of the same number
  double off_list, threshold;
  std::uint32_t first, count;  // in BatchSums::kept, in the order of before()
};
struct GroupRow {
  std::uint32_t block, group;
  MomentSums arrived, absorbed;
};
enum class MapKind : std::uint32_t { image, angles, quadrants, field };
struct CellRow {
  std::uint64_t route;  // of a field, otherwise 0
  std::uint32_t block, receiver, cell;
  MapKind map;
  double power, real, imaginary;
};

template <template <class> class Array>
struct BatchRows {
  Array<BlockRow> blocks;
  Array<TotalRow> routes, receivers;
  Array<KeptRow> routes_kept;
  Array<double> route_tails, receiver_tails;
  Array<ScoreAddress> kept;
  Array<GroupRow> groups;
  Array<CellRow> cells;
};
using BatchSums = BatchRows<GrowingList>;

}  // namespace straytrace
