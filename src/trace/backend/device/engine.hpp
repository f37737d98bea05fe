// SPDX-License-Identifier: BSD-3-Clause
// The engine runs many histories at once on a device. It is a shared library that is loaded on request; the program
// itself does not depend on it.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "trace/tally/history_tally.hpp"

namespace straytrace::trace {

// The histories of a batch: any set of whole blocks. Within the batch they are numbered from 0.
struct BatchHistories {
  std::uint64_t const* blocks = nullptr;
  STRAY_HD std::uint64_t operator()(std::uint32_t number) const {
    return blocks[number / largest_block] * largest_block + number % largest_block;
  }
};

// `history`: its number in the batch; `place` counts the records of one history.
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
  std::uint32_t again;  // out of space: the host has to run it; bits of the lists that were full
};

// Lists that were full: bit i for list i of TallyLists, bit 4 + i for the list that all histories share.
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
  std::uint32_t first, count;  // in BatchSums::kept, the largest priority first
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

// The records of one history: for those that ran out of space.
struct HistoryRun {
  HistoryRecord record;
  TallyLists<GrowingList> lists;
};

struct BatchOrder {
  std::uint64_t seed = 1;
  std::vector<std::uint64_t> blocks;
  // Space for the records of one history: totals, scores, arrivals, cells; 0: chosen by the engine.
  std::uint32_t room = 0;
};

struct DeviceFacts {
  std::string name;                  // of the device
  std::size_t memory = 0;            // bytes
  std::uint32_t blocks_at_once = 1;  // that keep it busy
  std::uint32_t workers = 0;         // histories under way at once
  double occupancy = 0;              // of its threads, by the walk
  std::uint32_t registers = 0;       // of a thread of the walk
  std::size_t local_bytes = 0;       // of a thread of the walk, besides
};

struct BatchCounts {
  std::uint64_t run_again = 0;  // histories out of space
  std::size_t bytes = 0;        // of device memory used by this engine
};

// Paths that move together, in the order of phase_sum (noise/time_domain/phase_sum.hpp): `phase_sensitivity` by path
// and coordinate, `position` by coordinate and sample.
struct PhaseOrder {
  std::span<double const> amplitude, turns, phase_sensitivity, position;
  std::size_t coordinates = 0, samples = 0;
};

class DeviceEngine {
 public:
  virtual ~DeviceEngine() = default;
  virtual DeviceFacts facts() const = 0;
  // Memory for the image of a world; its previous content is lost.
  virtual void* room_for_world(std::size_t bytes) = 0;
  virtual void load_world(std::span<std::byte const> placed) = 0;
  // Sums of the blocks, in the order of blocks. `again` runs a history on the host.
  virtual BatchSums run(BatchOrder const&, std::function<HistoryRun(std::uint64_t)> const& again, BatchCounts&) = 0;
  virtual std::vector<std::complex<double>> phase_sum(PhaseOrder const&) = 0;
};

// The library exports this as `straytrace_device_engine`: throws std::runtime_error, with the reason in
// words, when there is no device.
using MakeDeviceEngine = DeviceEngine* (*)(std::uint32_t abi);
constexpr std::uint32_t device_abi = 2;  // changes with anything in this file or in its includes

}  // namespace straytrace::trace
