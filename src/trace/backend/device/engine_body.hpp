// SPDX-License-Identifier: BSD-3-Clause
// An engine for any machine supported by the library of parallel algorithms. The machine provides:
//   facts()                     see engine.hpp
//   workers(), stride()         of the walk (history_kernel.hpp)
//   launch(workers, walk)       runs walk(0) to walk(workers - 1)
#pragma once

#include <array>
#include <atomic>
#include <complex>
#include <thread>

#include "base/math/simd.hpp"
#include "trace/backend/device/engine.hpp"
#include "trace/backend/device/history_kernel.hpp"
#include "trace/backend/device/ordered.hpp"
#include "trace/backend/device/sums.hpp"

namespace straytrace::trace::device {

struct SumPhases {
  double const *amplitude, *turns, *phase_sensitivity, *position;
  std::size_t paths, coordinates, samples;
  double *real, *imaginary;
  STRAY_HD void operator()(std::uint32_t i) const {
    double re = 0, im = 0;
    for (std::size_t j = 0; j < paths; ++j) {
      double phase = turns[j];
      for (std::size_t c = 0; c < coordinates; ++c) {
        double const by = phase_sensitivity[j * coordinates + c];
        if (by != 0) phase += by * position[c * samples + i];
      }
      add_turned(phase, amplitude[j], re, im);
    }
    real[i] = re;
    imaginary[i] = im;
  }
};

inline std::vector<std::complex<double>> summed_phases(PhaseOrder const& o) {
  Array<double> const amplitude(o.amplitude.begin(), o.amplitude.end()), turns(o.turns.begin(), o.turns.end()),
      phase_sensitivity(o.phase_sensitivity.begin(), o.phase_sensitivity.end()),
      position(o.position.begin(), o.position.end());
  Array<double> real(o.samples), imaginary(o.samples);
  for_each_number(std::uint32_t(o.samples),
                  SumPhases{data_of(amplitude), data_of(turns), data_of(phase_sensitivity), data_of(position),
                            o.amplitude.size(), o.coordinates, o.samples, data_of(real), data_of(imaginary)});
  std::vector<double> re(o.samples), im(o.samples);
  thrust::copy(real.begin(), real.end(), re.begin());
  thrust::copy(imaginary.begin(), imaginary.end(), im.begin());
  std::vector<std::complex<double>> sum(o.samples);
  for (std::size_t i = 0; i < o.samples; ++i) sum[i] = {re[i], im[i]};
  return sum;
}

// Memory behind a common list, and behind the slabs of all workers. It only grows: to fill new memory takes longer than
// the walk.
template <class T>
struct Memory {
  Array<Recorded<T>> common;
  std::size_t written = 0;  // of `common`
  Array<T> slabs;
  Slab<T> slab(std::uint32_t workers, std::uint32_t room) {
    if (std::size_t const size = std::size_t(workers) * room; slabs.size() < size) slabs.resize(size);
    return {data_of(slabs), room, 0, false};
  }
  CommonList<T> list(std::size_t room, std::uint32_t* count) {
    if (common.size() < room) common.resize(room);
    return {data_of(common), std::uint32_t(room), count};
  }
  Records<Recorded<T>> records() const { return {data_of(common), written}; }
  void append(std::vector<Recorded<T>> const& more) {
    if (written + more.size() > common.size()) common.resize(written + more.size());
    thrust::copy(more.begin(), more.end(), common.begin() + std::ptrdiff_t(written));
    written += more.size();
  }
  std::size_t bytes() const { return common.capacity() * sizeof(Recorded<T>) + slabs.capacity() * sizeof(T); }
};

struct RunsAgain {
  HistoryRecord const* histories;
  STRAY_HD bool operator()(std::uint32_t i) const { return histories[i].again != 0; }
};

template <class Machine>
class EngineBody final : public DeviceEngine {
 public:
  DeviceFacts facts() const override { return machine_.facts(); }

  void* room_for_world(std::size_t bytes) override {
    world_.clear();
    world_.resize(bytes);
    return data_of(world_);
  }
  void load_world(std::span<std::byte const> placed) override {
    thrust::copy(placed.data(), placed.data() + placed.size(), world_.begin());
  }

  BatchSums run(BatchOrder const& order, std::function<HistoryRun(std::uint64_t)> const& again,
                BatchCounts& counts) override {
    walk(order);
    counts.run_again = run_rest(order, again);
    BatchSums sums = summed();
    counts.bytes = bytes();
    return sums;
  }

  std::vector<std::complex<double>> phase_sum(PhaseOrder const& order) override { return summed_phases(order); }

 private:
  // Capacity for the records of one history in each list: at most, and on average. Grows after an overflow.
  struct Room {
    std::uint32_t most, mean;
  };
  enum { for_totals, for_scores, for_arrivals, for_cells, lists };

  void walk(BatchOrder const& order) {
    auto const histories = std::uint32_t(order.blocks.size() * largest_block);
    std::uint32_t const workers = machine_.workers();
    std::array<Room, lists> rooms = rooms_;
    if (order.room > 0) rooms.fill({order.room, (order.room + 1) / 2});
    histories_.resize(histories);
    blocks_.assign(order.blocks.begin(), order.blocks.end());
    Array<std::uint32_t> counters(5, 0);
    std::uint32_t* const counter = data_of(counters);
    auto const most = [&](int list) { return rooms[list].most; };
    auto const shared = [&](int list) { return std::size_t(rooms[list].mean) * histories; };
    DeviceWalk walk;
    walk.world = reinterpret_cast<WorldView const*>(data_of(world_));
    walk.seed = order.seed;
    walk.number = {data_of(blocks_)};
    walk.histories = histories;
    walk.stride = machine_.stride();
    walk.begun = counter;
    walk.workers = workers;
    walk.slabs = {totals_.slab(workers, most(for_totals)), scores_.slab(workers, most(for_scores)),
                  arrivals_.slab(workers, most(for_arrivals)), cells_.slab(workers, most(for_cells))};
    walk.common = {data_of(histories_),
                   {totals_.list(shared(for_totals), counter + 1), scores_.list(shared(for_scores), counter + 2),
                    arrivals_.list(shared(for_arrivals), counter + 3), cells_.list(shared(for_cells), counter + 4)}};
    machine_.launch(workers, walk);
    std::vector<std::uint32_t> taken(counters.size());
    thrust::copy(counters.begin(), counters.end(), taken.begin());
    totals_.written = std::min<std::size_t>(shared(for_totals), taken[1]);
    scores_.written = std::min<std::size_t>(shared(for_scores), taken[2]);
    arrivals_.written = std::min<std::size_t>(shared(for_arrivals), taken[3]);
    cells_.written = std::min<std::size_t>(shared(for_cells), taken[4]);
  }

  // Histories that ran out of space are run on the host; their records are added to the lists, which the order of the
  // sums then treats like all others.
  std::uint64_t run_rest(BatchOrder const& order, std::function<HistoryRun(std::uint64_t)> const& again) {
    auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
    auto const n = std::uint32_t(histories_.size());
    Array<std::uint32_t> found(n);
    auto const end = thrust::copy_if(thrust::device, zero, zero + n, found.begin(), RunsAgain{data_of(histories_)});
    if (end == found.begin()) return 0;
    std::vector<std::uint32_t> rest(std::size_t(end - found.begin()));
    thrust::copy(found.begin(), end, rest.begin());
    std::vector<TotalRecord> totals;
    std::vector<ScoreRecord> scores;
    std::vector<ArrivalRecord> arrivals;
    std::vector<CellsRecord> cells;
    std::uint32_t short_of = 0;
    std::vector<HistoryRun> const ran =
        run_together(rest, [&](std::uint32_t history) { return again(BatchHistories{order.blocks.data()}(history)); });
    for (std::size_t i = 0; i < rest.size(); ++i) {
      std::uint32_t const history = rest[i];
      HistoryRun const& run = ran[i];
      short_of |= HistoryRecord(histories_[history]).again;
      histories_[history] = run.record;
      write(totals, run.lists.totals, history);
      write(scores, run.lists.scores, history);
      write(arrivals, run.lists.arrivals, history);
      write(cells, run.lists.cells, history);
    }
    totals_.append(totals);
    scores_.append(scores);
    arrivals_.append(arrivals);
    cells_.append(cells);
    if (rest.size() > n / 20000) make_room(short_of);
    return rest.size();
  }
  // On all cores of the host, while the device waits.
  template <class RunOne>
  static std::vector<HistoryRun> run_together(std::vector<std::uint32_t> const& histories, RunOne const& run_one) {
    std::vector<HistoryRun> runs(histories.size());
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> threads;
    std::size_t const most = std::max(1u, std::thread::hardware_concurrency());
    while (threads.size() < std::min(most, histories.size()))
      threads.emplace_back([&] {
        for (std::size_t i = next++; i < runs.size(); i = next++) runs[i] = run_one(histories[i]);
      });
    threads.clear();
    return runs;
  }
  template <class T>
  static void write(std::vector<Recorded<T>>& to, std::vector<T> const& list, std::uint32_t history) {
    for (std::uint32_t i = 0; i < list.size(); ++i) to.push_back({history, i, list[i]});
  }
  std::size_t bytes() const {
    return world_.size() + histories_.capacity() * sizeof(HistoryRecord) + totals_.bytes() + scores_.bytes() +
           arrivals_.bytes() + cells_.bytes();
  }
  // As long as it is a quarter of the memory at most: sorting needs about as much again, and stacks need space.
  void make_room(std::uint32_t short_of) {
    if (bytes() > machine_.facts().memory / 4) return;
    for (int i = 0; i < lists; ++i) {
      if (short_of >> i & 1) rooms_[i].most *= 2;
      if (short_of >> (shared_list + i) & 1) rooms_[i].mean *= 2;
    }
  }

  BatchSums summed() {
    BatchHistories const number{data_of(blocks_)};
    BatchRows<Array> rows;
    make_block_rows(histories_, number, rows.blocks);
    make_total_rows(totals_.records(), number, rows.routes, rows.route_tails);
    make_kept_rows(scores_.records(), rows.routes_kept, rows.kept);
    auto const by_receiver = totals_by_receiver(totals_.records());
    make_total_rows(records_of(by_receiver), number, rows.receivers, rows.receiver_tails);
    make_group_rows(arrivals_.records(), number, rows.groups);
    make_cell_rows(cells_.records(), rows.cells);
    BatchSums sums;
    fetch(rows.blocks, sums.blocks);
    fetch(rows.routes, sums.routes);
    fetch(rows.receivers, sums.receivers);
    fetch(rows.routes_kept, sums.routes_kept);
    fetch(rows.route_tails, sums.route_tails);
    fetch(rows.receiver_tails, sums.receiver_tails);
    fetch(rows.kept, sums.kept);
    fetch(rows.groups, sums.groups);
    fetch(rows.cells, sums.cells);
    return sums;
  }
  template <class T>
  static void fetch(Array<T> const& from, std::vector<T>& to) {
    to.resize(from.size());
    if (!from.empty()) thrust::copy(from.begin(), from.end(), to.begin());
  }

  Machine machine_;
  std::array<Room, lists> rooms_{Room{64, 16}, {512, 64}, {64, 32}, {256, 64}};
  Array<std::byte> world_;
  Array<std::uint64_t> blocks_;
  Array<HistoryRecord> histories_;
  Memory<HistoryTotal> totals_;
  Memory<HistoryScore> scores_;
  Memory<HistoryArrival> arrivals_;
  Memory<HistoryCells> cells_;
};

}  // namespace straytrace::trace::device
