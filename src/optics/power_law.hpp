// SPDX-License-Identifier: BSD-3-Clause
// Small-angle scatter of mirrors: BSDF = kappa theta^-n for theta >= above, theta = angle from the specular direction
// (physics.md eq. 3.18). Below `above` the light belongs to the modes (hand-over angle, requirements.md R2.31).
// Page: docs/reference/scatter/power-law.md.
#pragma once

#include "optics/bsdf.hpp"

namespace straytrace {

struct PowerLaw {
  double kappa = 0;     // 1/sr, with theta in rad
  double exponent = 2;  // n
  double above = 5e-5;  // rad
  AlbedoTable table;    // set by prepare()
  double total = 1;     // integral(pi), set by prepare()
  static constexpr char const* key = "power-law";

  void prepare();  // host: normalises the sampling and fills the albedo table by quadrature

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const theta = angle_between(specular(wi), wo);
    return theta >= above ? kappa * power_positive(theta, -exponent) : 0;
  }
  // Sampled with density theta^(1-n) in theta over [above, pi]: eval/pdf is then bounded by sin(theta)/theta.
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const theta = angle_between(specular(wi), wo);
    return theta >= above ? density(theta) : 0;
  }
  STRAY_HD double albedo(double cos_i) const { return table.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    double const theta = quantile(u);
    SinCos const polar = sincos_turn(theta / (2 * pi)), azimuth = sincos_turn(v);
    Frame const f = Frame::around(specular(wi));
    Vec3 const wo = f.to_world({polar.sin * azimuth.cos, polar.sin * azimuth.sin, polar.cos});
    if (!(wo.z > 0) || theta < above) return {wo, 0};
    return {wo, density(theta)};
  }

  STRAY_HD double density(double theta) const {  // 1/sr
    return power_positive(theta, 1 - exponent) / (total * 2 * pi * sincos_turn(theta / (2 * pi)).sin);
  }
  // Integral of theta^(1-n) from `above` to theta, and the angle below which a share u of it lies.
  STRAY_HD double integral(double theta) const {
    double const m = 2 - exponent;
    return m == 0 ? log_positive(theta / above) : (power_positive(theta, m) - power_positive(above, m)) / m;
  }
  STRAY_HD double quantile(double u) const {
    double const m = 2 - exponent;
    if (m == 0) return above * exp_number(u * log_positive(pi / above));
    double const low = power_positive(above, m);
    return power_positive(low + u * (power_positive(pi, m) - low), 1 / m);
  }
};

// Virgo's statistical 1/theta^2 law (physics.md eq. 3.19, 3.20): a mirror scatters the total fraction `tis` with polar
// density kappa_s/theta^2 between `above` and pi/2; returns kappa_s (dimensionless), so kappa = tis kappa_s/(2 pi).
double statistical_kappa(double above);
// Integral of sin(t)/t^2 from a to b = [-sin t/t + Ci(t)]_a^b (eq. 3.20), angles in (0, pi].
double statistical_integral(double a, double b);

}  // namespace straytrace
