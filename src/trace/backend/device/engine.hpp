// SPDX-License-Identifier: BSD-3-Clause
// A machine that runs many histories at once, in a shared library of its own that is loaded when it is asked for: the
// program itself needs nothing of it.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "trace/backend/device/records.hpp"

namespace straytrace {

// What one history would have written: for those that did not fit.
struct HistoryRun {
  HistoryRecord record;
  TallyLists<GrowingList> lists;
};

struct BatchOrder {
  std::uint64_t seed = 1;
  std::vector<std::uint64_t> blocks;
  // Room for what one history writes: totals, scores, arrivals, cells; 0: as much as the engine thinks good.
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
  std::uint64_t run_again = 0;  // histories that did not fit
  std::size_t bytes = 0;        // of device memory that this engine holds
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
  // Memory for the image of a world; what it held before is lost.
  virtual void* room_for_world(std::size_t bytes) = 0;
  virtual void load_world(std::span<std::byte const> placed) = 0;
  // Sums of the blocks, in the order of blocks. `again` runs a history on the host.
  virtual BatchSums run(BatchOrder const&, std::function<HistoryRun(std::uint64_t)> const& again, BatchCounts&) = 0;
  virtual std::vector<std::complex<double>> phase_sum(PhaseOrder const&) = 0;
};

// What the library offers under the name `straytrace_device_engine`: throws std::runtime_error, with the reason in
// words, when there is no device.
using MakeDeviceEngine = DeviceEngine* (*)(std::uint32_t abi);
constexpr std::uint32_t device_abi = 1;  // changes with anything in this file or in what it includes

}  // namespace straytrace
