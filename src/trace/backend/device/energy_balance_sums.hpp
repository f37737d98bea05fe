// SPDX-License-Identifier: BSD-3-Clause
// The energy balance of each block, what arrives on each group, and the cells of maps, summed on the device in the
// order of histories, as BlockSink does (totals.hpp).
#pragma once

#include "trace/backend/device/totals.hpp"

namespace straytrace::device {

struct MakeBlockRow {
  HistoryRecord const* histories;
  BlockRow* rows;
  BatchHistories number;
  // Number i: column i % (batch_columns + 1) of a block; the last one sums what has no moments.
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
inline void make_group_rows(Array<ArrivalRecord> const& arrivals, BatchHistories number, Array<GroupRow>& rows) {
  auto const keys = ordered(arrivals.size(), ByGroup{data_of(arrivals)});
  auto const starts = runs(keys, 2);  // block and group
  rows.resize(run_count(starts));
  for_each_number(rows.size(), MakeGroupRow{run_of(arrivals, keys, starts), data_of(rows), number});
}

// What one score adds to the cell of one map: number i is map i % 4 of record i / 4.
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
inline void make_cell_rows(Array<CellsRecord> const& cells, Array<CellRow>& rows) {
  CellOf const cell_of{data_of(cells)};
  auto const keys = ordered(4 * cells.size(), ByCell{cell_of});
  auto const starts = runs(keys, 4);  // block, map, route and cell
  rows.resize(run_count(starts));
  for_each_number(rows.size(), MakeCellRow{run_of(keys, starts), cell_of, data_of(rows)});
}

}  // namespace straytrace::device
