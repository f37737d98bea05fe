// SPDX-License-Identifier: BSD-3-Clause
// The engine on an NVIDIA device. This file contains only launches: the work of the threads is in trace/backend/device
// and in the physics headers shared with the host.
#include "trace/backend/device/noinline.hpp"
//
#include <cuda_runtime.h>
#include <stdexcept>

#include "trace/backend/device/engine_body.hpp"

namespace straytrace::trace::device {
namespace {

constexpr int threads = 128;  // of a block: small, since run times of threads differ widely

__global__ void __launch_bounds__(threads) walk_kernel(DeviceWalk walk) { walk(blockIdx.x * threads + threadIdx.x); }

void check(cudaError_t error) {
  if (error != cudaSuccess) throw std::runtime_error(std::string("CUDA: ") + cudaGetErrorString(error));
}

class Cuda {
 public:
  Cuda() {
    int devices = 0;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0)
      throw std::runtime_error("no GPU with a driver for CUDA was found (nvidia-smi lists them)");
    cudaDeviceProp device;
    check(cudaGetDeviceProperties(&device, 0));
    cudaFuncAttributes kernel;
    check(cudaFuncGetAttributes(&kernel, walk_kernel));
    int resident = 0;
    check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&resident, walk_kernel, threads, 0));
    facts_.name = device.name;
    facts_.memory = device.totalGlobalMem;
    facts_.workers = std::uint32_t(device.multiProcessorCount * resident * threads);
    facts_.occupancy = double(resident * threads) / device.maxThreadsPerMultiProcessor;
    facts_.registers = std::uint32_t(kernel.numRegs);
    facts_.local_bytes = kernel.localSizeBytes;
    // So many histories for each thread that the last ones of a batch are a small part of it, if memory allows.
    std::uint32_t const each = facts_.memory > std::size_t{32} << 30 ? 16 : 4;
    facts_.blocks_at_once = std::max<std::uint32_t>(16, each * facts_.workers / std::uint32_t(largest_block));
  }
  DeviceFacts facts() const { return facts_; }
  std::uint32_t workers() const { return facts_.workers; }
  std::uint32_t stride() const { return 1; }
  void launch(std::uint32_t workers, DeviceWalk const& walk) const {
    walk_kernel<<<(workers + threads - 1) / threads, threads>>>(walk);
    check(cudaGetLastError());
    check(cudaDeviceSynchronize());
  }

 private:
  DeviceFacts facts_;
};

}  // namespace
}  // namespace straytrace::trace::device

extern "C" __attribute__((visibility("default"))) straytrace::trace::DeviceEngine* straytrace_device_engine(
    std::uint32_t abi) {
  if (abi != straytrace::trace::device_abi)
    throw std::runtime_error("libstraytrace_cuda.so is from another version of straytrace");
  return new straytrace::trace::device::EngineBody<straytrace::trace::device::Cuda>();
}
