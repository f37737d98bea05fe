// SPDX-License-Identifier: BSD-3-Clause
// Further random numbers that follow from two given ones: samples by rejection stay functions of (u, v).
#pragma once

#include <cstdint>
#include <cstring>

#include "base/memory/host_device.hpp"

namespace straytrace {

// A sequence of uniform numbers in [0, 1), fixed by u and v (splitmix64; Steele, Lea, Flood 2014).
class Redraw {
 public:
  STRAY_HD Redraw(double u, double v) {
    std::uint64_t a, b;
    std::memcpy(&a, &u, sizeof a);
    std::memcpy(&b, &v, sizeof b);
    state_ = mixed(a) ^ (b * 0xd6e8feb86659fd93ull);
  }
  STRAY_HD double next() {
    state_ += 0x9e3779b97f4a7c15ull;
    return static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
  }

 private:
  STRAY_HD static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

}  // namespace straytrace
