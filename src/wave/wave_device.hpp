// SPDX-License-Identifier: BSD-3-Clause
// Round trips of a cavity on a device, in a shared library that is loaded on request; the program itself does not
// depend on it. Fields agree with those of the host to rounding, some 1e-15 of the largest value per leg: the
// transforms are those of the library of the device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "wave/field.hpp"
#include "wave/lines/line_kernels.hpp"

namespace straytrace {
class ThreadTeam;
}

namespace straytrace::wave {

// A field on its way through the legs and planes of a cavity.

// A leg, and the plane at its end with the rows about the axis beyond which nothing passes.
struct LegAndPlane {
  LegTables leg;
  int columns = 0;  // of the spectrum that the leg lets through
  PlaneFactor plane;
  int rows = 0;
};
inline int blocks_of(LegAndPlane const& p) { return 2 * ((p.columns / 2 + block_lines - 1) / block_lines); }
inline RowRange rows_of(LegAndPlane const& p, int points) { return {points / 2 - p.rows / 2, points / 2 + p.rows / 2}; }
// Who looks at the fields that arrive at planes, and where; empty: everywhere.
struct Watch {
  std::function<void(std::size_t plane, Field const& arriving)> seen;
  std::function<bool(std::size_t plane)> looks;
  bool at(std::size_t plane) const { return seen && (!looks || looks(plane)); }
};
inline std::size_t size_of(BlockedField const& f) {
  return std::size_t(f.blocks) * std::size_t(f.rows) * 2 * block_lines;
}

// From spectrum to spectrum. Each leg reads and writes the field twice: all columns there, through the leg and back,
// then all rows back, through the plane and there. Rows and columns that hold nothing are left out, but where somebody
// looks, all rows come to the plane. The same bits for any number of threads, any processor, and whoever looks.
class HostTrip {
 public:
  HostTrip(LineTables const&, Grid const&, std::vector<LegAndPlane>, int threads);

  // Columns beyond those of the first leg count as zero, and become zero.
  void run(Field& spectrum, Watch const& = {}) const;

 private:
  void take(Field const& spectrum, BlockedField const&) const;
  void put(BlockedField const&, Field& spectrum) const;
  void columns(ThreadTeam&, LegAndPlane const&, BlockedField const& from, BlockedField const& to, RowRange given,
               RowRange wanted) const;
  void rows(ThreadTeam&, LegAndPlane const&, LegAndPlane const& next, BlockedField const&, Field* seen) const;

  LineTables const& tables_;
  Grid grid_;
  std::vector<LegAndPlane> legs_;
  unsigned threads_;
  int blocks_ = 0, rows_ = 0;
};

// As HostTrip, of one thread at a time.
class DeviceTrip {
 public:
  virtual ~DeviceTrip() = default;
  virtual void run(Field& spectrum, Watch const&) = 0;
  // The tables that the legs and planes point to have other numbers.
  virtual void take_tables() = 0;
};

class WaveDevice {
 public:
  virtual ~WaveDevice() = default;
  virtual std::string name() const = 0;
  // The legs and planes point to tables that outlive the trip, which this device must outlive.
  virtual std::unique_ptr<DeviceTrip> trip(Grid const&, std::vector<LegAndPlane>) = 0;
};

// What computes fields: this device, or without one so many threads of the host (0: all).
struct Computing {
  int threads;
  std::shared_ptr<WaveDevice> device;

  Computing(int count = 1, std::shared_ptr<WaveDevice> on = {})  // NOLINT: a number of threads is one
      : threads(count), device(std::move(on)) {}
};

// Calls of a device, whose failures become errors with a remedy: InputError where the field does not fit into its
// memory, NumericalError where it fails at work.
std::unique_ptr<DeviceTrip> prepared(WaveDevice&, Grid const&, std::vector<LegAndPlane>);
void run(DeviceTrip&, Field& spectrum, Watch const&);

// The device of a shared library. InputError when it cannot be loaded or finds no device.
std::shared_ptr<WaveDevice> load_waves(std::string const& library);
// That of libstraytrace_cufft.so beside the program. InputError when it was not built, cannot be loaded or finds no
// device.
std::shared_ptr<WaveDevice> cuda_waves();

// The library exports this as `straytrace_wave_device`; std::runtime_error, as all that its classes throw, with the
// reason in words, when there is no device.
using MakeWaveDevice = WaveDevice* (*)(std::uint32_t abi);
constexpr std::uint32_t wave_device_abi = 1;  // changes with anything in this file or in its includes

}  // namespace straytrace::wave
