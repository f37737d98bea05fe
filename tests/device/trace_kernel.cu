// SPDX-License-Identifier: BSD-3-Clause
// The history loop as a kernel: compiled where nvcc is found, so that the physics headers stay device code.
#include "trace/history/step.hpp"

namespace {

struct CouplingSink {
  double total = 0;
  STRAY_HD void emitted(straytrace::PathState const&, straytrace::Vertex const&) {}
  STRAY_HD void visit(straytrace::PathState const&, straytrace::Vertex const&) {}
  STRAY_HD void score(straytrace::PathState const&, straytrace::Vertex const&, std::uint32_t, std::uint32_t,
                      straytrace::Vertex const&, double coupling) {
    total += coupling;
  }
  STRAY_HD void book(straytrace::Fate, double) {}
};

}  // namespace

__global__ void trace_kernel(straytrace::WorldView world, std::uint64_t seed, double* coupling) {
  CouplingSink sink;
  std::uint64_t const history = blockIdx.x * std::uint64_t(blockDim.x) + threadIdx.x;
  straytrace::trace_history(world, seed, history, sink);
  coupling[history] = sink.total;
}
