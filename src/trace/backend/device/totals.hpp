// SPDX-License-Identifier: BSD-3-Clause
// Sums over the histories of each block by route and by receiver, on the device, in the order in which BlockSink adds:
// one thread per row, history after history, so that no bit depends on who was first. No atomics.
#pragma once

#include "trace/backend/device/ordered.hpp"
#include "trace/backend/device/records.hpp"
#include "trace/tally/add_total.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::device {

using TotalRecord = Recorded<HistoryTotal>;
using ScoreRecord = Recorded<HistoryScore>;

template <class T>
STRAY_HD std::uint32_t block_of(Recorded<T> const& r) {
  return r.history / std::uint32_t(block_size);
}
// By block and route, then as the histories wrote them.
struct AsWritten {
  template <class T>
  STRAY_HD bool operator()(Recorded<T> const& a, Recorded<T> const& b) const {
    if (block_of(a) != block_of(b)) return block_of(a) < block_of(b);
    if (a.what.route != b.what.route) return a.what.route < b.what.route;
    return a.history != b.history ? a.history < b.history : a.place < b.place;
  }
};
struct SameRoute {
  template <class T>
  STRAY_HD bool operator()(Recorded<T> const& a, Recorded<T> const& b) const {
    return block_of(a) == block_of(b) && a.what.route == b.what.route;
  }
};
struct LargestTotalFirst {
  STRAY_HD bool operator()(TotalRecord const& a, TotalRecord const& b) const {
    if (!SameRoute()(a, b)) return AsWritten()(a, b);
    return a.what.sum != b.what.sum ? a.what.sum > b.what.sum : a.history < b.history;
  }
};
struct LargestPriorityFirst {
  STRAY_HD bool operator()(ScoreRecord const& a, ScoreRecord const& b) const {
    if (!SameRoute()(a, b)) return AsWritten()(a, b);
    ScoreAddress const &p = a.what.address, &q = b.what.address;  // as before() does
    if (p.priority != q.priority) return p.priority > q.priority;
    if (p.history != q.history) return p.history < q.history;
    if (p.event != q.event) return p.event < q.event;
    if (p.connection != q.connection) return p.connection < q.connection;
    return a.place < b.place;
  }
};

struct MakeTotalRow {
  Run<TotalRecord> run;
  TotalRow* rows;
  BatchHistories number;
  STRAY_HD void operator()(std::uint32_t i) const {
    TotalRecord const& any = run[run.begin(i)];
    TotalRow row{any.what.route, block_of(any), any.what.port, {}, 0, 0};
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) {
      add_total(row.moments, run[k].what.sum, number(run[k].history));
      row.tails += run[k].what.sum > 0 && row.tails < tail_size;
    }
    rows[i] = row;
  }
};
struct CopyTail {
  Run<TotalRecord> run;  // largest first
  TotalRow const* rows;
  double* tails;
  STRAY_HD void operator()(std::uint32_t i) const {
    for (std::uint32_t k = 0; k < rows[i].tails; ++k) tails[rows[i].first_tail + k] = run[run.begin(i) + k].what.sum;
  }
};
// One record per history and route at most.
inline void make_total_rows(Array<TotalRecord> const& totals, BatchHistories number, Array<TotalRow>& rows,
                            Array<double>& tails) {
  Array<std::uint32_t> order = ordered(totals, AsWritten());
  Array<std::uint32_t> const starts = runs(totals, order, SameRoute());
  rows.resize(run_count(starts));
  for_each_number(run_count(starts), MakeTotalRow{run_of(totals, order, starts), data_of(rows), number});
  tails.resize(lay_out(rows, &TotalRow::first_tail, &TotalRow::tails));
  order = ordered(totals, LargestTotalFirst());
  for_each_number(run_count(starts), CopyTail{run_of(totals, order, starts), data_of(rows), data_of(tails)});
}

struct MakeKeptRow {
  Run<ScoreRecord> written, largest;
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
  Run<ScoreRecord> largest;
  KeptRow const* rows;
  ScoreAddress* kept;
  STRAY_HD void operator()(std::uint32_t i) const {
    for (std::uint32_t k = 0; k < rows[i].count; ++k) kept[rows[i].first + k] = largest[largest.begin(i) + k].what.address;
  }
};
// Every route that has a total has a score: the rows are those of the totals.
inline void make_kept_rows(Array<ScoreRecord> const& scores, Array<KeptRow>& rows, Array<ScoreAddress>& kept) {
  Array<std::uint32_t> const order = ordered(scores, AsWritten()), largest = ordered(scores, LargestPriorityFirst());
  Array<std::uint32_t> const starts = runs(scores, order, SameRoute());
  auto const by_priority = run_of(scores, largest, starts);
  rows.resize(run_count(starts));
  for_each_number(run_count(starts), MakeKeptRow{run_of(scores, order, starts), by_priority, data_of(rows)});
  kept.resize(lay_out(rows, &KeptRow::first, &KeptRow::count));
  for_each_number(run_count(starts), CopyKept{by_priority, data_of(rows), data_of(kept)});
}

// What each history brought to each receiver: its totals there, in the order in which they were first met.
struct IsReceived {
  STRAY_HD bool operator()(TotalRecord const& r) const { return r.what.port >= first_receiver_end; }
};
struct NamedByEnd {
  STRAY_HD TotalRecord operator()(TotalRecord r) const {
    r.what.route = r.what.port;
    return r;
  }
};
struct SameHistory {
  STRAY_HD bool operator()(TotalRecord const& a, TotalRecord const& b) const {
    return a.history == b.history && a.what.route == b.what.route;
  }
};
struct SumOfHistory {
  Run<TotalRecord> run;
  TotalRecord* sums;
  STRAY_HD void operator()(std::uint32_t i) const {
    TotalRecord sum = run[run.begin(i)];
    sum.what.sum = 0;
    for (std::uint32_t k = run.begin(i); k < run.end(i); ++k) sum.what.sum += run[k].what.sum;
    sums[i] = sum;
  }
};
inline Array<TotalRecord> totals_by_receiver(Array<TotalRecord> const& totals) {
  Array<TotalRecord> received(totals.size());
  auto const end =
      thrust::copy_if(thrust::device, totals.begin(), totals.end(), received.begin(), IsReceived());
  received.resize(std::size_t(end - received.begin()));
  thrust::transform(thrust::device, received.begin(), received.end(), received.begin(), NamedByEnd());
  Array<std::uint32_t> const order = ordered(received, AsWritten()), starts = runs(received, order, SameHistory());
  Array<TotalRecord> sums(run_count(starts));
  for_each_number(run_count(starts), SumOfHistory{run_of(received, order, starts), data_of(sums)});
  return sums;
}

}  // namespace straytrace::device
