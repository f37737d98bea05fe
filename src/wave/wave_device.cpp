// SPDX-License-Identifier: BSD-3-Clause
#include "wave/wave_device.hpp"

#include "base/errors.hpp"
#include "base/process/library.hpp"

namespace straytrace::wave {
namespace {

constexpr char const* on_host = "use --backend cpu, whose fields agree to rounding";

}  // namespace

std::unique_ptr<DeviceTrip> prepared(WaveDevice& device, Grid const& grid, std::vector<Passage> passages) {
  try {
    return device.trip(grid, std::move(passages));
  } catch (std::runtime_error const& e) {
    throw InputError("wave: " + device.name() + ": " + e.what(),
                     std::string("choose fewer 'points' of 'grid', or ") + on_host);
  }
}

void run(DeviceTrip& trip, Field& spectrum, Watch const& watch) {
  try {
    trip.run(spectrum, watch);
  } catch (NumericalError const&) {  // of those who look
    throw;
  } catch (std::runtime_error const& e) {
    throw NumericalError(std::string("wave: ") + e.what() + "; " + on_host);
  }
}

std::shared_ptr<WaveDevice> load_waves(std::string const& library) {
  auto const make = reinterpret_cast<MakeWaveDevice>(
      library_symbol(library, "straytrace_wave_device", std::string("build it again, or ") + on_host));
  try {
    return std::shared_ptr<WaveDevice>(make(wave_device_abi));
  } catch (std::exception const& e) {
    throw InputError(e.what(), on_host);
  }
}

std::shared_ptr<WaveDevice> cuda_waves() {
  std::string const library = installed_library("libstraytrace_cufft.so");
  if (library.empty())
    throw InputError("this straytrace was built without cuFFT, which computes fields on a GPU",
                     std::string("build it where nvcc and cuFFT are found (docs/guide/gpu.md), or ") + on_host);
  return load_waves(library);
}

}  // namespace straytrace::wave
