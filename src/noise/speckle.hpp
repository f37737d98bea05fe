// SPDX-License-Identifier: BSD-3-Clause
// One realisation against the speckle mean (physics.md section 10).
#pragma once

namespace straytrace {

// Power |sum of fields|^2 of one speckle that a share `below` of the realisations stays under, over its mean; eq. 10.2.
double speckle_percentile(double below);

}  // namespace straytrace
