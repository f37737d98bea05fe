// SPDX-License-Identifier: BSD-3-Clause
#include "optics/polynomial.hpp"

#include "optics/lobe_prepare.hpp"

namespace straytrace {

void Polynomial::prepare() { lobe.prepare(*this, peak > 0 ? width : 1); }

}  // namespace straytrace
