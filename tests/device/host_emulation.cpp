// SPDX-License-Identifier: BSD-3-Clause
// The engine of a device on the host: the same kernels, sorts and sums, by the compiler of the host, with macros that
// tell it that it is that of a device. Its threads are threads of the host and finish their histories in a mixed order.
// clang-format off
#include <bits/stdc++.h>
#include <Random123/philox.h>
#include "base/every_module.hpp"
#include "trace/backend/device/ordered.hpp"

#define __CUDACC__ 1
#define __CUDA_ARCH__ 800
#define __host__
#define __device__
inline int __ffs(int bits) { return __builtin_ffs(bits); }
inline unsigned atomicAdd(unsigned* counter, unsigned count) {
  return __atomic_fetch_add(counter, count, __ATOMIC_RELAXED);
}
inline int __syncthreads_or(int flag) { return flag; }  // a block of one thread

#include "trace/backend/device/engine_body.hpp"
// clang-format on

namespace straytrace::trace::device {
namespace {

class HostEmulation {
 public:
  DeviceFacts facts() const { return {"emulation on the host", std::size_t{1} << 30, 4, workers(), 1, 0, 0}; }
  std::uint32_t workers() const { return 3; }
  std::uint32_t stride() const { return 1000003; }  // a prime: every history once, in a mixed order
  void launch(std::uint32_t workers, DeviceWalk const& walk) const {
    std::vector<std::jthread> threads;
    for (std::uint32_t i = 0; i < workers; ++i) threads.emplace_back([&walk, i] { walk(i); });
  }
};

}  // namespace
}  // namespace straytrace::trace::device

extern "C" __attribute__((visibility("default"))) straytrace::trace::DeviceEngine* straytrace_device_engine(
    std::uint32_t) {
  return new straytrace::trace::device::EngineBody<straytrace::trace::device::HostEmulation>();
}
