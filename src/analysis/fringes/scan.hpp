// SPDX-License-Identifier: BSD-3-Clause
// Least squares in one parameter that may have several minima: by scanning.
#pragma once

#include <functional>
#include <vector>

namespace straytrace {

struct ScanResult {
  double best = 0, chi_square = 0;
  double low = 0, high = 0;    // chi^2 + 1: one standard error; `low` = start of the scan: none below
  double limit = 0;            // chi^2 + 2.71 above: 95 %, one-sided
  bool open = false;           // chi^2 never rises to the limit within the scan
  std::vector<double> others;  // further minima within chi^2 + 4: as good answers
};
// From `from` to `to` in `steps` equal steps, each minimum refined. The function is finite.
ScanResult scan_minimum(std::function<double(double)> const& chi_square, double from, double to, int steps);

}  // namespace straytrace
