// SPDX-License-Identifier: BSD-3-Clause
#include "optics/gaussian.hpp"

#include "optics/lobe_prepare.hpp"

namespace straytrace {

void Gaussian::prepare() { lobe.prepare(*this, width); }

}  // namespace straytrace
