// SPDX-License-Identifier: BSD-3-Clause
// Power of a motion on the lines of a transform.
#pragma once

#include <vector>

#include "signal/spectrum.hpp"

namespace straytrace {

// Integrals of one spectrum, kept between calls: a line is asked for by every node. Not for several threads at once.
class LinePowers {
 public:
  // At k > 0: from (k - 1/2) to (k + 1/2) spacing [Hz]; at least `count` of them. Valid until the next call.
  std::vector<double> const& at(Spectrum const&, double spacing, std::size_t count);

 private:
  double spacing_ = 0;
  std::vector<double> power_;
};

}  // namespace straytrace
