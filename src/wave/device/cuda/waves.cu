// SPDX-License-Identifier: BSD-3-Clause
// Round trips on an NVIDIA device with cuFFT. This file contains only calls of CUDA: what happens to a field is in
// wave/device.
#include <cuda_runtime.h>
#include <cufft.h>
#include <memory>
#include <stdexcept>
#include <string>

#include "wave/device/trip_body.hpp"

namespace straytrace::wave::device {
namespace {

constexpr unsigned block_threads = 256;

void check(cudaError_t error, char const* what) {
  if (error != cudaSuccess) throw std::runtime_error(std::string("CUDA, ") + what + ": " + cudaGetErrorString(error));
}
void check(cufftResult result, char const* what) {
  if (result != CUFFT_SUCCESS)
    throw std::runtime_error(std::string("cuFFT, ") + what + ": error " + std::to_string(int(result)) +
                             (result == CUFFT_ALLOC_FAILED ? " (out of memory)" : " of cufft.h"));
}

template <class Work>
__global__ void __launch_bounds__(block_threads) work_kernel(std::uint32_t count, Work work) {
  std::uint32_t const i = blockIdx.x * block_threads + threadIdx.x;
  if (i < count) work(i);
}

struct Freed {
  void operator()(double* memory) const { cudaFree(memory); }
};

class DeviceMemory {
 public:
  DeviceMemory() = default;
  explicit DeviceMemory(std::size_t count) {
    void* memory = nullptr;
    check(cudaMalloc(&memory, count * sizeof(double)), "memory for a field or its tables");
    memory_.reset(static_cast<double*>(memory));
  }
  double* get() const { return memory_.get(); }

 private:
  std::unique_ptr<double, Freed> memory_;
};

// A plan whose work area comes later, so that memory can be refused before it is taken.
class Plan {
 public:
  explicit Plan(int points) {
    check(cufftCreate(&plan_), "a plan");
    try {
      check(cufftSetAutoAllocation(plan_, 0), "a plan without memory");
      check(cufftMakePlan2d(plan_, points, points, CUFFT_Z2Z, &bytes_), "a plan of the transform");
    } catch (...) {
      cufftDestroy(plan_);
      throw;
    }
  }
  ~Plan() { cufftDestroy(plan_); }
  Plan(Plan const&) = delete;
  Plan& operator=(Plan const&) = delete;

  std::size_t bytes() const { return bytes_; }
  void begin() {
    work_ = DeviceMemory(bytes_ / sizeof(double) + 1);
    check(cufftSetWorkArea(plan_, work_.get()), "the work area of the transform");
  }
  void run(double* values, bool forward) {
    auto* const field = reinterpret_cast<cufftDoubleComplex*>(values);
    check(cufftExecZ2Z(plan_, field, field, forward ? CUFFT_FORWARD : CUFFT_INVERSE), "a transform");
  }

 private:
  cufftHandle plan_ = 0;
  std::size_t bytes_ = 0;
  DeviceMemory work_;
};

class Cuda {
 public:
  using Memory = DeviceMemory;
  explicit Cuda(int points) : plan_(points) {}

  std::size_t work_bytes() const { return plan_.bytes(); }
  std::size_t free_bytes() const {
    std::size_t free = 0, all = 0;
    check(cudaMemGetInfo(&free, &all), "the amount of free memory");
    return free;
  }
  void begin() { plan_.begin(); }
  void put(double* to, double const* from, std::size_t count) {
    check(cudaMemcpy(to, from, count * sizeof(double), cudaMemcpyHostToDevice), "a copy to the device");
  }
  // It waits for all work before, so errors of kernels and transforms appear here at the latest.
  void get(double* to, double const* from, std::size_t count) {
    check(cudaMemcpy(to, from, count * sizeof(double), cudaMemcpyDeviceToHost), "legs, or a copy from the device");
  }
  void transform(double* values, bool forward) { plan_.run(values, forward); }
  template <class Work>
  void each(std::size_t count, Work const& work) {
    auto const blocks = unsigned((count + block_threads - 1) / block_threads);
    work_kernel<<<blocks, block_threads>>>(std::uint32_t(count), work);
    check(cudaGetLastError(), "the start of a leg or plane");
  }

 private:
  Plan plan_;
};

class CudaWaves final : public WaveDevice {
 public:
  CudaWaves() {
    int devices = 0;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0)
      throw std::runtime_error("no GPU with a driver for CUDA was found (nvidia-smi lists them)");
    cudaDeviceProp device;
    check(cudaGetDeviceProperties(&device, 0), "the properties of device 0");
    name_ = device.name;
  }
  std::string name() const override { return name_; }
  std::unique_ptr<DeviceTrip> trip(Grid const& grid, std::vector<LegAndPlane> legs) override {
    return std::make_unique<TripBody<Cuda>>(grid, std::move(legs));
  }

 private:
  std::string name_;
};

}  // namespace
}  // namespace straytrace::wave::device

extern "C" __attribute__((visibility("default"))) straytrace::wave::WaveDevice* straytrace_wave_device(
    std::uint32_t abi) {
  if (abi != straytrace::wave::wave_device_abi)
    throw std::runtime_error("libstraytrace_cufft.so is from another version of straytrace");
  return new straytrace::wave::device::CudaWaves();
}
