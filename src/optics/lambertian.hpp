// SPDX-License-Identifier: BSD-3-Clause
// Lambertian scatter: BSDF = reflectance/pi (physics.md eq. 3.3). Page: docs/reference/scatter/lambertian.md.
#pragma once

#include "optics/bsdf.hpp"

namespace straytrace {

struct Lambertian {
  double reflectance = 0;  // total hemispherical, dimensionless
  static constexpr char const* key = "lambertian";

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const { return wi.z > 0 && wo.z > 0 ? reflectance / pi : 0; }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return wi.z > 0 && wo.z > 0 ? wo.z / pi : 0; }
  STRAY_HD double albedo(double) const { return reflectance; }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    double const rho = std::sqrt(u), z = std::sqrt(1 - u);
    SinCos const a = sincos_turn(v);
    return {{rho * a.cos, rho * a.sin, z}, z / pi};
  }
};

}  // namespace straytrace
