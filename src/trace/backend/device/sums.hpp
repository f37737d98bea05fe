// SPDX-License-Identifier: BSD-3-Clause
// Sums over the histories of each block by route and by receiver, on the device, in the order in which BlockSink adds:
// one thread per row, history after history, so that no bit depends on thread order. No atomics.
#pragma once

#include "trace/backend/device/engine.hpp"
#include "trace/backend/device/ordered.hpp"
#include "trace/result.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::trace::device {

using TotalRecord = Recorded<HistoryTotal>;
using ScoreRecord = Recorded<HistoryScore>;

template <class T>
STRAY_HD std::uint64_t block_of(Recorded<T> const& r) {
  return r.history == no_history ? nothing : r.history / largest_block;
}
// By block and route, then in the order written by the histories.
template <class T>
struct AsWritten {
  static constexpr int words = 3;
  Recorded<T> const* records;
  STRAY_HD SortKey operator()(std::uint32_t i) const {
    Recorded<T> const& r = records[i];
    return {{block_of(r), r.what.route, pair_of(r.history, r.place)}};
  }
};
struct LargestTotalFirst {
  static constexpr int words = 4;
  TotalRecord const* records;
  STRAY_HD SortKey operator()(std::uint32_t i) const {
    TotalRecord const& r = records[i];
    return {{block_of(r), r.what.route, falling(r.what.sum), r.history}};
  }
};
struct LargestPriorityFirst {  // as ByPriority in result.cpp
  static constexpr int words = 5;
  ScoreRecord const* records;
  STRAY_HD SortKey operator()(std::uint32_t i) const {
    ScoreRecord const& r = records[i];
    ScoreAddress const& a = r.what.address;
    return {{block_of(r), r.what.route, falling(a.priority), a.history, pair_of(a.event, a.connection)}};
  }
};
constexpr int block_and_route = 2;  // words

struct MakeTotalRow {
  RecordRun<TotalRecord> run;
  TotalRow* rows;
  BatchHistories number;
  STRAY_HD void operator()(std::uint32_t i) const {
    TotalRecord const& any = run[run.begin(i)];
    TotalRow row{any.what.route, std::uint32_t(block_of(any)), any.what.port, {}, 0, 0};
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) {
      add_total(row.moments, run[k].what.sum, number(run[k].history));
      row.tails += run[k].what.sum > 0 && row.tails < tail_size;
    }
    rows[i] = row;
  }
};
struct CopyTail {
  RecordRun<TotalRecord> largest;
  TotalRow const* rows;
  double* tails;
  STRAY_HD void operator()(std::uint32_t i) const {
    for (std::uint32_t k = 0; k < rows[i].tails; ++k)
      tails[rows[i].first_tail + k] = largest[largest.begin(i) + k].what.sum;
  }
};
// One record per history and route at most.
inline void make_total_rows(Records<TotalRecord> totals, BatchHistories number, Array<TotalRow>& rows,
                            Array<double>& tails) {
  AsWritten<HistoryTotal> const as_written{totals.data};
  auto const written = ordered(totals.size, as_written);
  auto const starts = runs(written, as_written, block_and_route);
  rows.resize(run_count(starts));
  for_each_number(rows.size(), MakeTotalRow{run_of(totals, written, starts), data_of(rows), number});
  tails.resize(lay_out(rows, &TotalRow::first_tail, &TotalRow::tails));
  auto const largest = ordered(totals.size, LargestTotalFirst{totals.data});
  for_each_number(rows.size(), CopyTail{run_of(totals, largest, starts), data_of(rows), data_of(tails)});
}

struct MakeKeptRow {
  RecordRun<ScoreRecord> written, largest;
  KeptRow* rows;
  STRAY_HD void operator()(std::uint32_t i) const {
    KeptRow row{};
    for (std::uint32_t k = written.begin(i); k < written.end(i); ++k) {
      if (written[k].what.off_list) row.off_list += written[k].what.address.coupling;
      row.count += written[k].what.address.priority > 0;
    }
    if (row.count > records_per_class) {
      row.threshold = largest[largest.begin(i) + std::uint32_t(records_per_class)].what.address.priority;
      row.count = std::uint32_t(records_per_class);
    }
    rows[i] = row;
  }
};
struct CopyKept {
  RecordRun<ScoreRecord> largest;
  KeptRow const* rows;
  ScoreAddress* kept;
  STRAY_HD void operator()(std::uint32_t i) const {
    for (std::uint32_t k = 0; k < rows[i].count; ++k)
      kept[rows[i].first + k] = largest[largest.begin(i) + k].what.address;
  }
};
// Every route that has a total has a score: the rows are those of the totals.
inline void make_kept_rows(Records<ScoreRecord> scores, Array<KeptRow>& rows, Array<ScoreAddress>& kept) {
  AsWritten<HistoryScore> const as_written{scores.data};
  auto const written = ordered(scores.size, as_written);
  auto const by_priority = ordered(scores.size, LargestPriorityFirst{scores.data});
  auto const starts = runs(written, as_written, block_and_route);
  auto const largest = run_of(scores, by_priority, starts);
  rows.resize(run_count(starts));
  for_each_number(rows.size(), MakeKeptRow{run_of(scores, written, starts), largest, data_of(rows)});
  kept.resize(lay_out(rows, &KeptRow::first, &KeptRow::count));
  for_each_number(rows.size(), CopyKept{largest, data_of(rows), data_of(kept)});
}

// Totals of each history at each receiver, in the order of their first score. The route of
// these totals is the number of the end.
struct ByReceiver {
  static constexpr int words = 4;
  TotalRecord const* records;
  STRAY_HD SortKey operator()(std::uint32_t i) const {
    TotalRecord const& r = records[i];
    if (r.what.port < first_receiver_end) return {{nothing}};
    return {{block_of(r), r.what.port, r.history, r.place}};
  }
};
struct SumOfHistory {
  RecordRun<TotalRecord> run;
  TotalRecord* sums;
  STRAY_HD void operator()(std::uint32_t i) const {
    TotalRecord sum = run[run.begin(i)];
    sum.what.route = sum.what.port;
    sum.what.sum = 0;
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) sum.what.sum += run[k].what.sum;
    sums[i] = sum;
  }
};
inline Array<TotalRecord> totals_by_receiver(Records<TotalRecord> totals) {
  ByReceiver const by_receiver{totals.data};
  auto const order = ordered(totals.size, by_receiver);
  auto const starts = runs(order, by_receiver, 3);  // block, end and history
  Array<TotalRecord> sums(run_count(starts));
  for_each_number(sums.size(), SumOfHistory{run_of(totals, order, starts), data_of(sums)});
  return sums;
}

// The energy balance of each block, what arrives on each group, and the cells of maps, summed on the device in the
// order of histories, as BlockSink does (totals.hpp).

struct MakeBlockRow {
  HistoryRecord const* histories;
  BlockRow* rows;
  BatchHistories number;
  // Number i: column i % (batch_columns + 1) of a block; the last one sums columns without moments.
  STRAY_HD void operator()(std::uint32_t i) const {
    std::uint32_t const block = i / (batch_columns + 1), column = i % (batch_columns + 1);
    std::uint32_t const begin = block * std::uint32_t(largest_block), end = begin + std::uint32_t(largest_block);
    BlockRow& row = rows[block];
    if (column < batch_columns) {
      MomentSums sums;
      for (std::uint32_t h = begin; h < end; ++h) add_total(sums, histories[h].column[column], number(h));
      row.column[column] = sums;
      return;
    }
    row.window_variance = 0;
    row.bounces = row.lost = 0;
    for (std::uint32_t h = begin; h < end; ++h) {
      row.window_variance += histories[h].window_variance;
      row.bounces += histories[h].bounces;
      row.lost += histories[h].lost;
    }
  }
};
inline void make_block_rows(Array<HistoryRecord> const& histories, BatchHistories number, Array<BlockRow>& rows) {
  rows.resize(histories.size() / largest_block);
  for_each_number(rows.size() * (batch_columns + 1), MakeBlockRow{data_of(histories), data_of(rows), number});
}

using ArrivalRecord = Recorded<HistoryArrival>;
struct ByGroup {
  static constexpr int words = 3;
  ArrivalRecord const* records;
  STRAY_HD SortKey operator()(std::uint32_t i) const {
    return {{block_of(records[i]), records[i].what.group, records[i].history}};
  }
};
struct MakeGroupRow {
  RecordRun<ArrivalRecord> run;
  GroupRow* rows;
  BatchHistories number;
  STRAY_HD void operator()(std::uint32_t i) const {
    ArrivalRecord const& any = run[run.begin(i)];
    GroupRow row{std::uint32_t(block_of(any)), any.what.group, {}, {}};
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) {
      add_total(row.arrived, run[k].what.power, number(run[k].history));
      add_total(row.absorbed, run[k].what.absorbed, number(run[k].history));
    }
    rows[i] = row;
  }
};
inline void make_group_rows(Records<ArrivalRecord> arrivals, BatchHistories number, Array<GroupRow>& rows) {
  ByGroup const by_group{arrivals.data};
  auto const order = ordered(arrivals.size, by_group);
  auto const starts = runs(order, by_group, 2);  // block and group
  rows.resize(run_count(starts));
  for_each_number(rows.size(), MakeGroupRow{run_of(arrivals, order, starts), data_of(rows), number});
}

// The contribution of one score to the cell of one map: number i is map i % 4 of record i / 4.
using CellsRecord = Recorded<HistoryCells>;
struct CellOf {
  CellsRecord const* records;
  STRAY_HD CellRow operator()(std::uint32_t i) const {
    CellsRecord const& r = records[i / 4];
    HistoryCells const& c = r.what;
    auto const map = static_cast<MapKind>(i % 4);
    CellRow row{0, std::uint32_t(block_of(r)), c.receiver, c.pixel, map, c.power, 0, 0};
    if (map == MapKind::angles) row.cell = c.angle_pixel;
    if (map == MapKind::quadrants) row.cell = c.quadrant;
    if (map == MapKind::field) {
      row.route = c.route;
      row.real = c.real;
      row.imaginary = c.imaginary;
      if (!c.coherent) row.cell = Receiver::outside;
    }
    return row;
  }
};
struct ByCell {
  static constexpr int words = 5;
  CellOf cell_of;
  STRAY_HD SortKey operator()(std::uint32_t i) const {
    CellsRecord const& r = cell_of.records[i / 4];
    CellRow const c = cell_of(i);
    if (r.history == no_history || c.cell == Receiver::outside) return {{nothing}};
    return {{c.block, pair_of(c.receiver, std::uint32_t(c.map)), c.route, c.cell, pair_of(r.history, r.place)}};
  }
};
struct MakeCellRow {
  Run run;
  CellOf cell_of;
  CellRow* rows;
  STRAY_HD void operator()(std::uint32_t i) const {
    CellRow row = cell_of(run.record(run.begin(i)));
    row.power = row.real = row.imaginary = 0;
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) {
      CellRow const one = cell_of(run.record(k));
      row.power += one.power;
      row.real += one.real;
      row.imaginary += one.imaginary;
    }
    rows[i] = row;
  }
};
inline void make_cell_rows(Records<CellsRecord> cells, Array<CellRow>& rows) {
  CellOf const cell_of{cells.data};
  ByCell const by_cell{cell_of};
  auto const order = ordered(4 * cells.size, by_cell);
  auto const starts = runs(order, by_cell, 4);  // block, map, route and cell
  rows.resize(run_count(starts));
  for_each_number(rows.size(), MakeCellRow{run_of(order, starts), cell_of, data_of(rows)});
}

}  // namespace straytrace::trace::device
