// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/microfacet.hpp"

namespace straytrace {

void Microfacet::prepare() {
  for (int k = 0; k < cosines; ++k) {
    double const u = alpha * uncrowded(k / (cosines - 1.0), 1 / alpha);
    double const cosine = std::fmin(1, std::fmax(u, 1e-12));  // stands for the limit at grazing
    Vec3 const wi{std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
    totals[k] = facets_total({alpha, alpha, reflectance, grazing}, wi) - factor(cosine);
  }
}

}  // namespace straytrace
