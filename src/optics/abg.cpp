// SPDX-License-Identifier: BSD-3-Clause
#include "optics/abg.hpp"

#include "optics/lobe_prepare.hpp"

namespace straytrace {

void Abg::prepare() { lobe.prepare(*this, b > 0 ? power_positive(b, 1 / std::fmax(g, 0.1)) : 1e-6); }

}  // namespace straytrace
