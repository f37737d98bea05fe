// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace straytrace {

// Where responses are asked for, Hz.
struct Band {
  double low = 10, high = 100;
  double clamped(double hz) const { return hz < low ? low : hz > high ? high : hz; }
};

}  // namespace straytrace
