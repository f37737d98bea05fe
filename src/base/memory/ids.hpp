// SPDX-License-Identifier: BSD-3-Clause
// Identifiers that cannot be mixed up, a non-owning array for kernels, and what routes are described by: events, phase
// sensitivities and blocks of histories.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/memory/host_device.hpp"

namespace straytrace {

template <class Tag>
struct Id {
  std::uint32_t value = 0xffffffffu;
  STRAY_HD bool valid() const { return value != 0xffffffffu; }
  STRAY_HD bool operator==(Id o) const { return value == o.value; }
  STRAY_HD bool operator!=(Id o) const { return value != o.value; }
  STRAY_HD bool operator<(Id o) const { return value < o.value; }
};
using SurfaceId = Id<struct SurfaceTag>;
using GroupId = Id<struct GroupTag>;
using BodyId = Id<struct BodyTag>;
using PortId = Id<struct PortTag>;

// A non-owning array that a kernel takes by value (std::span is host-only in CUDA).
template <class T>
struct View {
  T* data = nullptr;
  std::size_t size = 0;
  STRAY_HD T& operator[](std::size_t i) const { return data[i]; }
};

// Interaction of light with a surface along a route.
enum class Event : std::uint8_t { emit, scatter, reflect, couple, transmit, receive, start, diffract };

// d(phase)/d(coordinate) of one body: x, y, z [rad/m], then rotations about its pivot [rad/rad].
// Relative to the main mode's own phase (docs/theory/motion.md, eq. 2.3, 2.5).
struct PhaseSensitivity {
  BodyId body;
  double d[6] = {};
  // First moment over the delays: sum over the hits of their part of d times the time [s] from the hit to where the
  // light rejoins (docs/theory/time_domain.md, eq. N.29). NaN: not known.
  double moment[6] = {};

  void add(PhaseSensitivity const& other, double factor) {
    for (int i = 0; i < 6; ++i) {
      d[i] += factor * other.d[i];
      moment[i] += factor * other.moment[i];
    }
  }
};

// Sizes of the blocks in which histories are assigned to sources and summed. Part of the run-file schema, because the
// size of a block changes the result.
constexpr std::uint64_t largest_block = 4096, smallest_block = 8;
constexpr std::uint64_t enough_blocks = 32;  // to estimate an error from their spread

// Block size of a run: the largest of 4096, 512, 64 and 8 that gives `enough_blocks` blocks, the last one rounded up.
// The rounded number of histories gives the same size.
constexpr std::uint64_t block_size_of(std::uint64_t histories) {
  std::uint64_t size = largest_block;
  while (size > smallest_block && histories <= (enough_blocks - 1) * size) size /= 8;
  return size;
}

// Number of blocks, the last one rounded up.
constexpr std::uint64_t blocks_of(std::uint64_t histories, std::uint64_t block_size) {
  return (histories + block_size - 1) / block_size;
}

}  // namespace straytrace
