// SPDX-License-Identifier: BSD-3-Clause
#include "optics/harvey.hpp"

#include "optics/lobe_prepare.hpp"

namespace straytrace {

void Harvey::prepare() { lobe.prepare(*this, across > 0 ? std::fmin(width, across) : width); }

double Harvey::tis() const {
  double const l2 = width * width;
  if (std::fabs(slope + 2) < 1e-9) return pi * b0 * l2 * std::log1p(1 / l2);
  return 2 * pi * b0 * l2 * std::expm1((slope + 2) / 2 * std::log1p(1 / l2)) / (slope + 2);
}

}  // namespace straytrace
