// SPDX-License-Identifier: BSD-3-Clause
#include "optics/microfacet.hpp"

namespace straytrace {

// Mean of eval cos/pdf over a grid of (u, v), dense at v = 1, where the steep normals of the long tail are; it is
// continuous, because G vanishes at the horizon.
void Microfacet::prepare() {
  constexpr int across = 128, around = 32;
  auto const cell = [](int j) { return double(j) * j * j * j / (double(across) * across * across * across); };
  for (int k = 0; k < AlbedoTable::size; ++k) {
    double const cosine = std::fmax(AlbedoTable::cosine(k), 1e-9);  // stands for the limit at grazing
    Vec3 const wi{std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
    double sum = 0;
    for (int j = 0; j < across; ++j) {
      double const x = (j + 0.5) / across, width = cell(j + 1) - cell(j);
      for (int i = 0; i < around; ++i) {
        BsdfSample const s = sample(wi, 0.5 * (i + 0.5) / around, 1 - x * x * x * x);  // 1 - u: the mirror image
        if (s.pdf > 0) sum += width * eval(wi, s.wo) * s.wo.z / s.pdf;
      }
    }
    totals.value[k] = sum / around;
  }
}

}  // namespace straytrace
