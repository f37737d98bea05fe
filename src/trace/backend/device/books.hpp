// SPDX-License-Identifier: BSD-3-Clause
// The books of each block, what arrives on each group, and the cells of maps, summed on the device in the order of
// histories, as BlockSink does (totals.hpp).
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
    std::uint32_t const begin = block * std::uint32_t(block_size), end = begin + std::uint32_t(block_size);
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
  auto const blocks = std::uint32_t(histories.size() / block_size);
  rows.resize(blocks);
  for_each_number(blocks * (batch_columns + 1), MakeBlockRow{data_of(histories), data_of(rows), number});
}

using ArrivalRecord = Recorded<HistoryArrival>;
struct GroupOrder {
  STRAY_HD bool operator()(ArrivalRecord const& a, ArrivalRecord const& b) const {
    if (block_of(a) != block_of(b)) return block_of(a) < block_of(b);
    return a.what.group != b.what.group ? a.what.group < b.what.group : a.history < b.history;
  }
};
struct SameGroup {
  STRAY_HD bool operator()(ArrivalRecord const& a, ArrivalRecord const& b) const {
    return block_of(a) == block_of(b) && a.what.group == b.what.group;
  }
};
struct MakeGroupRow {
  Run<ArrivalRecord> run;
  GroupRow* rows;
  BatchHistories number;
  STRAY_HD void operator()(std::uint32_t i) const {
    ArrivalRecord const& any = run[run.begin(i)];
    GroupRow row{block_of(any), any.what.group, {}, {}};
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) {
      add_total(row.arrived, run[k].what.power, number(run[k].history));
      add_total(row.absorbed, run[k].what.absorbed, number(run[k].history));
    }
    rows[i] = row;
  }
};
inline void make_group_rows(Array<ArrivalRecord> const& arrivals, BatchHistories number, Array<GroupRow>& rows) {
  Array<std::uint32_t> const order = ordered(arrivals, GroupOrder()), starts = runs(arrivals, order, SameGroup());
  rows.resize(run_count(starts));
  for_each_number(run_count(starts), MakeGroupRow{run_of(arrivals, order, starts), data_of(rows), number});
}

// What one score adds to one cell of one map.
using CellsRecord = Recorded<HistoryCells>;
struct CellEntry {
  CellRow row;
  std::uint32_t history, place;
};
struct EntryOf {  // number i: map i % 4 of record i / 4
  CellsRecord const* records;
  STRAY_HD CellEntry operator()(std::uint32_t i) const {
    CellsRecord const& r = records[i / 4];
    HistoryCells const& c = r.what;
    auto const map = static_cast<MapKind>(i % 4);
    std::uint32_t const cell = map == MapKind::angles      ? c.angle_pixel
                               : map == MapKind::quadrants ? c.quadrant
                               : map == MapKind::image     ? c.pixel
                               : c.coherent                ? c.pixel
                                                           : Receiver::outside;
    bool const field = map == MapKind::field;
    return {{field ? c.route : 0, block_of(r), c.receiver, cell, map, c.power, field ? c.real : 0,
             field ? c.imaginary : 0},
            r.history,
            r.place};
  }
};
struct IsInside {
  STRAY_HD bool operator()(CellEntry const& e) const { return e.row.cell != Receiver::outside; }
};
struct SameCell {
  STRAY_HD bool operator()(CellEntry const& a, CellEntry const& b) const {
    return a.row.block == b.row.block && a.row.receiver == b.row.receiver && a.row.map == b.row.map &&
           a.row.route == b.row.route && a.row.cell == b.row.cell;
  }
};
struct CellOrder {
  STRAY_HD bool operator()(CellEntry const& a, CellEntry const& b) const {
    CellRow const &p = a.row, &q = b.row;
    if (p.block != q.block) return p.block < q.block;
    if (p.receiver != q.receiver) return p.receiver < q.receiver;
    if (p.map != q.map) return p.map < q.map;
    if (p.route != q.route) return p.route < q.route;
    if (p.cell != q.cell) return p.cell < q.cell;
    return a.history != b.history ? a.history < b.history : a.place < b.place;
  }
};
struct MakeCellRow {
  Run<CellEntry> run;
  CellRow* rows;
  STRAY_HD void operator()(std::uint32_t i) const {
    CellRow row = run[run.begin(i)].row;
    row.power = row.real = row.imaginary = 0;
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) {
      row.power += run[k].row.power;
      row.real += run[k].row.real;
      row.imaginary += run[k].row.imaginary;
    }
    rows[i] = row;
  }
};
inline void make_cell_rows(Array<CellsRecord> const& cells, Array<CellRow>& rows) {
  auto const candidates = std::uint32_t(4 * cells.size());
  auto const all = thrust::make_transform_iterator(thrust::make_counting_iterator(std::uint32_t{0}),
                                                   EntryOf{data_of(cells)});
  Array<CellEntry> entries(candidates);
  auto const end = thrust::copy_if(thrust::device, all, all + candidates, entries.begin(), IsInside());
  entries.resize(std::size_t(end - entries.begin()));
  Array<std::uint32_t> const order = ordered(entries, CellOrder()), starts = runs(entries, order, SameCell());
  rows.resize(run_count(starts));
  for_each_number(run_count(starts), MakeCellRow{run_of(entries, order, starts), data_of(rows)});
}

}  // namespace straytrace::device
