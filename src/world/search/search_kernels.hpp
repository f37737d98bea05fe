// SPDX-License-Identifier: BSD-3-Clause
// The questions a trace asks of a world, compiled for each instruction set and chosen when the program starts.
// Every set gives the same bits: no operation is contracted, and lanes do what a loop would do.
#pragma once

#include <cstdint>
#include <string_view>

namespace straytrace {

struct Departure;
struct Hit;
struct Ray;
struct RayQuery;
struct WorldView;

struct SearchKernels {
  char const* name;
  Hit (*closest)(WorldView const&, Ray const&, Departure const& from);
  void (*closest_together)(WorldView const&, RayQuery const*, Hit*, std::uint32_t count);
  bool (*occluded)(WorldView const&, Ray const&, Departure const& from, bool to_itself);
};

// The fastest this processor can run, or the one named by the environment variable STRAYTRACE_ISA.
extern SearchKernels const* search_kernels;

// "portable", "avx2" or "avx512"; nullptr: unknown, or this processor cannot run it.
SearchKernels const* find_search_kernels(std::string_view name);

}  // namespace straytrace
