// SPDX-License-Identifier: BSD-3-Clause
// Random numbers as a pure function of an address: (seed, history, event, purpose). What serves all events of a
// history, such as the points on goals, has a number of its own in place of the event. There is no shared state, so
// neither thread count nor block order can change a result. The counter layout is part of the run-file format.
#pragma once

#include <Random123/philox.h>

#include <cstdint>

#include "base/memory/host_device.hpp"

namespace straytrace {

// Purpose of a random number. A new purpose gets a new value; old values never change their meaning.
enum class Stream : std::uint32_t {
  source = 0,
  lobe = 1,
  direction = 2,
  connection = 3,
  window = 4,
  record = 5,
  receiver = 6,
  backward = 8,
  motion = 9,
  static_phase = 10,
  height = 11,
  halo = 12,
  choice = 13,
  strata = 14
};

class Rng {
 public:
  STRAY_HD Rng(std::uint64_t seed, std::uint64_t history, std::uint32_t event, Stream s)
      : counter_{{std::uint32_t(history), std::uint32_t(history >> 32), event, std::uint32_t(s) << 16}},
        key_{{std::uint32_t(seed), std::uint32_t(seed >> 32)}} {}

  // Uniform in the open interval (0, 1): safe for log().
  STRAY_HD double uniform() {
    if (left_ == 0) draw_block();
    --left_;
    std::uint64_t const bits = (std::uint64_t(word_[2 * left_ + 1]) << 32) | word_[2 * left_];
    return (double(std::int64_t(bits >> 12)) + 0.5) * 0x1.0p-52;
  }

  // Passes over `count` numbers; only before the first.
  STRAY_HD void skip(std::uint32_t count) {
    counter_[3] += count / 2;
    if (count % 2 != 0) uniform();
  }

 private:
  STRAY_HD void draw_block() {
    word_ = r123::Philox4x32()(counter_, key_);
    ++counter_[3];
    left_ = 2;
  }

  r123::Philox4x32::ctr_type counter_, word_;
  r123::Philox4x32::key_type key_;
  int left_ = 0;
};

}  // namespace straytrace
