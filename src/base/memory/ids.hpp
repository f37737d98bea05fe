// SPDX-License-Identifier: BSD-3-Clause
// Integers that cannot be mixed up, a non-owning array for kernels, and the phase sensitivity of a path on a body.
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

// d(phase)/d(coordinate) of one body: x, y, z [rad/m], then rotations about its pivot [rad/rad].
// Relative to the main mode's own phase (docs/theory/motion.md, eq. 2.3, 2.5).
struct PhaseSensitivity {
  BodyId body;
  double d[6] = {};
};

}  // namespace straytrace
