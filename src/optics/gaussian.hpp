// SPDX-License-Identifier: BSD-3-Clause
// Gaussian lobe in direction cosines: BSDF = peak exp(-|alpha - alpha_0|^2/(2 width^2)).
// Page: docs/reference/scatter/gaussian.md.
#pragma once

#include "optics/lobe_table.hpp"

namespace straytrace {

struct Gaussian {
  double peak = 0, width = 0.1;  // 1/sr, 1
  LobeTable<OffsetRings> lobe;   // set by prepare()
  static constexpr char const* key = "gaussian";

  void prepare();  // host

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const x = wo.x + wi.x, y = wo.y + wi.y;
    return peak * exp_number(-(x * x + y * y) / (2 * width * width));
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

}  // namespace straytrace
