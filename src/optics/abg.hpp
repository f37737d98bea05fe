// SPDX-License-Identifier: BSD-3-Clause
// ABg scatter law: BSDF = A/(B + |alpha - alpha_0|^g), alpha = projection of the outgoing direction on the surface,
// alpha_0 the same for the specular direction (physics.md eq. 3.16). Page: docs/reference/scatter/abg.md.
#pragma once

#include "optics/lobe_table.hpp"

namespace straytrace {

struct Abg {
  double a = 0, b = 1, g = 2;   // 1/sr, 1, 1
  LobeTable<OffsetRings> lobe;  // set by prepare()
  static constexpr char const* key = "abg";

  void prepare();  // host

  STRAY_HD double value(double offset) const { return a / (b + (offset > 0 ? power_positive(offset, g) : 0)); }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const { return wi.z > 0 && wo.z > 0 ? value(OffsetRings::of(wi, wo)) : 0; }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

}  // namespace straytrace
