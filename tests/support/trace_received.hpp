// SPDX-License-Identifier: BSD-3-Clause
// Black and other receivers in worlds built by hand, and what they received.
#pragma once

#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing {

// Counts the light on one side of a surface, or on both.
inline void receive_on(World& world, char const* name, SurfaceId surface, bool front = true, bool back = false) {
  Receiver r;
  r.surface = surface;
  r.front = front;
  r.back = back;
  world.add_receiver(name, r);
}
// As `straytrace trace` prepares it: receivers behind glass are found, targets and windows made.
inline void prepare(World& world) {
  world.finish();
  steer(world);
}
// Power on receiver number i, relative to the main mode.
inline SampleMean received(TraceResult const& r, std::size_t i = 0) {
  return sample_mean(r.coupling.received_power.at(i), (long long)r.total.histories);
}
// The same over the power first scattered, which every history scatters alike.
inline SampleMean received_share(TraceResult const& r, std::size_t i = 0) {
  return scaled(received(r, i), double(r.total.histories) / r.total.emitted.sum);
}

}  // namespace straytrace::testing
