// SPDX-License-Identifier: BSD-3-Clause
// Diffuse BSDF models: Lambertian, polynomial.
#pragma once

#include "optics/lobes/lobe_table.hpp"

namespace straytrace::optics {

// BSDF = reflectance/pi (docs/theory/surfaces.md, eq. 3.3). Page: docs/reference/scatter/lambertian.md.
struct Lambertian {
  double reflectance = 0;  // total hemispherical, dimensionless
  static constexpr char const* key = "lambertian";
  static ModelKeys<Lambertian> keys();

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const { return wi.z > 0 && wo.z > 0 ? reflectance * (1 / pi) : 0; }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return wi.z > 0 && wo.z > 0 ? wo.z * (1 / pi) : 0; }
  STRAY_HD double albedo(double) const { return reflectance; }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    double const rho = std::sqrt(u), z = std::sqrt(1 - u);
    SinCos const a = sincos_turn(v);
    return {{rho * a.cos, rho * a.sin, z}, z * (1 / pi)};
  }
};

// Diffuse black: symmetric polynomial in the cosines of incidence and scatter, and a forward lobe that rises towards
// grazing: BSDF = sum_jk c_jk cos_i^j cos_s^k + peak exp(-|alpha - alpha_0|^2/(2 width^2)) [(1-cos_i)(1-cos_s)]^rise.
// Page: docs/reference/scatter/polynomial.md.
struct Polynomial : SampledByLobe<Polynomial, OffsetRings> {
  static constexpr int terms = 4;
  double c[terms][terms] = {};             // 1/sr, c_jk = c_kj
  double peak = 0, width = 0.2, rise = 1;  // 1/sr, 1, 1
  LobeTable<OffsetRings> lobe;             // set by prepare()
  static constexpr char const* key = "polynomial";

  void prepare();  // host

  STRAY_HD double diffuse(double cos_i, double cos_s) const {
    double sum = 0;
    for (int j = terms - 1; j >= 0; --j) {
      double row = 0;
      for (int k = terms - 1; k >= 0; --k) row = row * cos_s + c[j][k];
      sum = sum * cos_i + row;
    }
    return sum;
  }
  STRAY_HD double value_at(Vec3 wi, Vec3 wo, double r2) const {
    double value = diffuse(wi.z, wo.z);
    double const grazing = (1 - wi.z) * (1 - wo.z);
    if (peak > 0 && grazing > 0) value += peak * exp_number(rise * log_positive(grazing) - r2 / (2 * width * width));
    return value;
  }
};

}  // namespace straytrace::optics
