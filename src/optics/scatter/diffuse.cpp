// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/diffuse.hpp"

#include "optics/lobes/lobe_prepare.hpp"

namespace straytrace {

void Polynomial::prepare() { lobe.prepare(*this, peak > 0 ? width : 1); }

}  // namespace straytrace
