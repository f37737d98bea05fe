// SPDX-License-Identifier: BSD-3-Clause
// Round trips of a cavity on a device, in a shared library that is loaded on request; the program itself does not
// depend on it. Fields agree with those of the host to rounding, some 1e-15 of the largest value per leg: the
// transforms are those of the library of the device.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "wave/passages.hpp"

namespace straytrace::wave {

// As Passages, of one thread at a time.
class DeviceTrip {
 public:
  virtual ~DeviceTrip() = default;
  virtual void run(Field& spectrum, Watch const&) = 0;
  // The tables that the passages point to have other numbers.
  virtual void take_tables() = 0;
};

class WaveDevice {
 public:
  virtual ~WaveDevice() = default;
  virtual std::string name() const = 0;
  // The passages point to tables that outlive the trip, which this device must outlive.
  virtual std::unique_ptr<DeviceTrip> trip(Grid const&, std::vector<Passage>) = 0;
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
std::unique_ptr<DeviceTrip> prepared(WaveDevice&, Grid const&, std::vector<Passage>);
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
