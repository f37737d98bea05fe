// SPDX-License-Identifier: BSD-3-Clause
#include "optics/angle_weight.hpp"

#include <algorithm>

#include "optics/scatter/law_types.hpp"
#include "optics/scatter/scatter_share.hpp"

namespace straytrace {

AngleWeight weight_of(LawPool const& pool, PoolRef ref, std::function<double(double)> const& weight) {
  constexpr int across = 256, around = 32;
  AngleWeight w;
  for (int i = 0; i < AlbedoTable::size; ++i) {
    w.root.value[i] = std::sqrt(weight(AlbedoTable::cosine(i)));
    w.most = std::max(w.most, w.root.value[i]);
  }
  for (int i = 0; i < AlbedoTable::size; ++i) {
    double const cosine = std::max(AlbedoTable::cosine(i), 1e-9);
    Vec3 const wi{std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
    double plain = 0, weighted = 0;
    pool.visit(ref, [&](auto const& law) {
      for (int k = 0; k < across * around; ++k) {
        BsdfSample const s = law.sample(wi, (k % across + 0.5) / across, (k / across + 0.5) / around);
        if (!(s.pdf > 0)) continue;
        double const value = law.eval(wi, s.wo) * s.wo.z / s.pdf;
        plain += value;
        weighted += value * w.root.at(s.wo.z);
      }
      w.albedo.value[i] = plain > 0 ? law.albedo(cosine) * w.root.value[i] * weighted / plain : 0;
    });
  }
  return w;
}

}  // namespace straytrace
