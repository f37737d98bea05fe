// SPDX-License-Identifier: BSD-3-Clause
// Small-angle scatter of mirrors: BSDF = kappa theta^-n for theta >= above, theta = angle from the specular direction
// (physics.md eq. 3.18). Below `above` the light belongs to the modes (hand-over angle, requirements.md R2.31).
// Page: docs/reference/scatter/power-law.md.
#pragma once

#include "optics/lobe_table.hpp"

namespace straytrace {

struct PowerLaw {
  double kappa = 0;            // 1/sr, with theta in rad
  double exponent = 2;         // n
  double above = 5e-5;         // rad
  LobeTable<ChordRings> lobe;  // set by prepare()
  static constexpr char const* key = "power-law";

  void prepare();  // host

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const theta = angle_between(specular(wi), wo);
    return theta >= above ? kappa * power_positive(theta, -exponent) : 0;
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

// Virgo's statistical 1/theta^2 law (physics.md eq. 3.19, 3.20): a mirror scatters the total fraction `tis` with polar
// density kappa_s/theta^2 between `above` and pi/2; returns kappa_s (dimensionless), so kappa = tis kappa_s/(2 pi).
double statistical_kappa(double above);
// Integral of sin(t)/t^2 from a to b = [-sin t/t + Ci(t)]_a^b (eq. 3.20), angles in (0, pi].
double statistical_integral(double a, double b);

}  // namespace straytrace
