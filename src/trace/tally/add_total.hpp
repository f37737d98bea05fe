// SPDX-License-Identifier: BSD-3-Clause
// Adding the total of a history to power sums: one text for what the host and a device add up in.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/memory/host_device.hpp"

namespace straytrace {

template <class Sums>
STRAY_HD void add_total(Sums& m, double total, std::uint64_t history) {
  if (total == 0) return;
  double const square = total * total;
  m.sum += total;
  m.sum2 += square;
  m.sum3 += square * total;
  m.sum4 += square * square;
  ++m.scored;
  if (std::fabs(total) > m.largest) {
    m.largest = std::fabs(total);
    m.largest_history = history;
  }
}

}  // namespace straytrace
