// SPDX-License-Identifier: BSD-3-Clause
// straytrace scan --invert: the scatter, motion or parameter that keeps the total under a line.
#pragma once

#include "app/scan_axes.hpp"
#include "app/scan_points.hpp"

namespace straytrace {

struct InvertOrder {
  std::string what;            // "brdf(steel)", "motion(tube)", "param(aperture)"
  bool per_frequency = false;  // the whole curve
  double tolerance = 0.01;     // param: width of the answer over the range
};

// Prints the answer; returns the exit code. `axes`: for param, the one range to look in.
int invert(Options const&, Requirement const&, InvertOrder const&, std::vector<ScanAxis> const& axes);

// The case of a parameter: traces at both ends of the range and between them.
int invert_parameter(Options const&, Requirement const&, InvertOrder const&, std::string const& name,
                     std::vector<ScanAxis> const& axes);

}  // namespace straytrace
