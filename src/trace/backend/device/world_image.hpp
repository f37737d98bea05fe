// SPDX-License-Identifier: BSD-3-Clause
// A world as one relocatable block of bytes, for example for the memory of a device: the view first, then every array
// that it references, directly or indirectly.
#pragma once

#include <cstddef>
#include <vector>

#include "world/model/view.hpp"

namespace straytrace::trace {

class WorldImage {
 public:
  explicit WorldImage(WorldView const&);

  static constexpr std::size_t alignment = 256;
  std::size_t size() const { return bytes_.size(); }
  // The bytes for a place that begins at this address: all pointers are addresses there.
  std::vector<std::byte> placed_at(void const* address) const;

 private:
  struct Pointer {
    std::size_t at, to;  // offsets: of the pointer, and of its target
  };
  class Writer;

  std::vector<std::byte> bytes_;
  std::vector<Pointer> pointers_;
};

}  // namespace straytrace::trace
