// SPDX-License-Identifier: BSD-3-Clause
// The searches of the trace, compiled for each instruction set; the program selects one when it starts. All sets give
// the same bits: no operation is contracted, and vector lanes do the operations of a loop.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {
struct Ray;
}  // namespace straytrace

namespace straytrace::world {

struct Departure;
struct Hit;
struct RayQuery;
struct WorldView;

struct SearchKernels {
  char const* name;
  Hit (*closest)(WorldView const&, Ray const&, Departure const& from);
  void (*closest_together)(WorldView const&, RayQuery const*, Hit*, std::uint32_t count);
  bool (*occluded)(WorldView const&, Ray const&, Departure const& from, bool to_itself);
};

// The fastest that this processor supports, or the one in the environment variable STRAYTRACE_ISA.
extern SearchKernels const* search_kernels;

// "portable", "avx2" or "avx512"; nullptr: unknown, or not supported by this processor.
SearchKernels const* find_search_kernels(std::string_view name);

}  // namespace straytrace::world
