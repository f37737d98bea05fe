// SPDX-License-Identifier: BSD-3-Clause
// Harvey scatter law: BSDF = b0 [1 + (|alpha - alpha_0|/l)^2]^(s/2) (physics.md eq. 3.14). Extended: two widths, along
// and across the plane of travel. That plane holds the mean of the incident and the outgoing travelling direction, so
// that the law stays reciprocal. Page: docs/reference/scatter/harvey.md.
#pragma once

#include "optics/lobe_table.hpp"

namespace straytrace {

struct Harvey {
  double b0 = 0, width = 0.01, slope = -1.5,
         across = 0;            // 1/sr, 1, 1; width: l, slope: s of eq. 3.14; across: the second width, 0: the same
  LobeTable<OffsetRings> lobe;  // set by prepare()
  static constexpr char const* key = "harvey";

  void prepare();      // host
  double tis() const;  // host: eq. 3.15, at normal incidence, one width

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const x = wo.x + wi.x, y = wo.y + wi.y;
    double square = (x * x + y * y) / (width * width);
    double const px = wo.x - wi.x, py = wo.y - wi.y, p2 = px * px + py * py;  // along the mean travelling direction
    if (across > 0 && p2 > 0) {
      double const along = (x * px + y * py) * (x * px + y * py) / p2, rest = std::fmax(0.0, x * x + y * y - along);
      square = along / (width * width) + rest / (across * across);
    }
    return b0 * power_positive(1 + square, slope / 2);
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

}  // namespace straytrace
