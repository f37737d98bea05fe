// SPDX-License-Identifier: BSD-3-Clause
// Polarisation factors Q of roughness scatter from one interface (docs/theory/surfaces.md, eq. 3.9): relative
// permittivity eps, or a constant reflectance for a coated mirror.
#pragma once

#include "base/math/vec3.hpp"

namespace straytrace {

struct PolarisationFactor {
  double permittivity_re = 0, permittivity_im = 0;  // both 0: constant
  double reflectance = 1;

  // Mean over the incident and sum over the outgoing polarisations.
  STRAY_HD double mean(Vec3 wi, Vec3 wo) const {
    if (permittivity_re == 0 && permittivity_im == 0) return reflectance;
    Four const q = each(wi, wo);
    return 0.5 * (q.ss + q.sp + q.ps + q.pp);
  }

  struct Four {
    double ss, sp, ps, pp;  // first letter: incident
  };
  STRAY_HD Four each(Vec3 wi, Vec3 wo) const {
    double const sin2_i = wi.x * wi.x + wi.y * wi.y, sin2_s = wo.x * wo.x + wo.y * wo.y,
                 sines = std::sqrt(sin2_i * sin2_s);
    // phi = 0: forward; where a sine is zero the sum does not depend on phi
    double const cos_phi = sines > 1e-12 ? -(wi.x * wo.x + wi.y * wo.y) / sines : 1;
    double const sin2_phi = std::fmax(0.0, 1 - cos_phi * cos_phi);
    Number const eps{permittivity_re, permittivity_im}, qi = root({eps.re - sin2_i, eps.im}),
                                                        qs = root({eps.re - sin2_s, eps.im});
    double const contrast = square({eps.re - 1, eps.im});
    double const s_i = square({wi.z + qi.re, qi.im}), s_s = square({wo.z + qs.re, qs.im});
    double const p_i = square({eps.re * wi.z + qi.re, eps.im * wi.z + qi.im}),
                 p_s = square({eps.re * wo.z + qs.re, eps.im * wo.z + qs.im});
    Number const qq{qi.re * qs.re - qi.im * qs.im, qi.re * qs.im + qi.im * qs.re};
    double const pp = square({qq.re * cos_phi - eps.re * sines, qq.im * cos_phi - eps.im * sines});
    return {contrast * cos_phi * cos_phi / (s_i * s_s), contrast * square(qs) * sin2_phi / (s_i * p_s),
            contrast * square(qi) * sin2_phi / (p_i * s_s), contrast * pp / (p_i * p_s)};
  }

 private:
  struct Number {
    double re, im;
  };
  STRAY_HD static double square(Number z) { return z.re * z.re + z.im * z.im; }
  STRAY_HD static Number root(Number z) {  // principal
    double const size = std::sqrt(square(z)), re = std::sqrt(std::fmax(0.0, 0.5 * (size + z.re))),
                 im = std::sqrt(std::fmax(0.0, 0.5 * (size - z.re)));
    return {re, z.im < 0 ? -im : im};
  }
};

}  // namespace straytrace
