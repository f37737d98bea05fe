// SPDX-License-Identifier: BSD-3-Clause
// BSDF models that depend on the offset from the specular direction: ABg, Gaussian, Harvey, power law.
#pragma once

#include "optics/lobes/lobe_table.hpp"

namespace straytrace::optics {

// ABg: BSDF = A/(B + |alpha - alpha_0|^g), alpha = projection of the outgoing direction on the surface, alpha_0 the
// same for the specular direction (docs/theory/surfaces.md, eq. 3.16). Page: docs/reference/scatter/abg.md.
struct Abg : SampledByLobe<Abg, OffsetRings> {
  double a = 0, b = 1, g = 2;   // 1/sr, 1, 1
  LobeTable<OffsetRings> lobe;  // set by prepare()
  static constexpr char const* key = "abg";
  static ModelKeys<Abg> keys();

  bool even_on_rings() const { return true; }  // host: value_at depends on r2 alone
  void prepare();                              // host

  STRAY_HD double value_at(Vec3, Vec3, double r2) const { return a / (b + (r2 > 0 ? half_power(r2, g) : 0)); }
};

// Gaussian lobe in direction cosines: BSDF = peak exp(-|alpha - alpha_0|^2/(2 width^2)).
// Page: docs/reference/scatter/gaussian.md.
struct Gaussian : SampledByLobe<Gaussian, OffsetRings> {
  double peak = 0, width = 0.1;  // 1/sr, 1
  LobeTable<OffsetRings> lobe;   // set by prepare()
  static constexpr char const* key = "gaussian";
  static ModelKeys<Gaussian> keys();

  bool even_on_rings() const { return true; }  // host: value_at depends on r2 alone
  void prepare();                              // host

  STRAY_HD double value_at(Vec3, Vec3, double r2) const { return peak * exp_number(-r2 / (2 * width * width)); }
};

// Harvey: BSDF = b0 [1 + (|alpha - alpha_0|/l)^2]^(s/2) (docs/theory/surfaces.md, eq. 3.14). Extended: two
// widths, along and across the plane of travel. That plane holds the mean of the incident and the outgoing travelling
// direction, so that the model stays reciprocal. Page: docs/reference/scatter/harvey.md.
struct Harvey : SampledByLobe<Harvey, OffsetRings> {
  double b0 = 0, width = 0.01, slope = -1.5,
         across = 0;            // 1/sr, 1, 1; width: l, slope: s of eq. 3.14; across: the second width, 0: the same
  LobeTable<OffsetRings> lobe;  // set by prepare()
  static constexpr char const* key = "harvey";
  static ModelKeys<Harvey> keys();
  ModelComplaint impossible() const;

  bool even_on_rings() const { return !(across > 0); }  // host: value_at depends on r2 alone
  void prepare();                                       // host
  double tis() const;                                   // host: eq. 3.15, at normal incidence, one width

  STRAY_HD double value_at(Vec3 wi, Vec3 wo, double r2) const {
    double square = r2 / (width * width);
    if (across > 0) {
      double const x = wo.x + wi.x, y = wo.y + wi.y;
      double const px = wo.x - wi.x, py = wo.y - wi.y, p2 = px * px + py * py;  // along the mean travelling direction
      if (p2 > 0) {
        double const along = (x * px + y * py) * (x * px + y * py) / p2, rest = r2 > along ? r2 - along : 0;
        square = along / (width * width) + rest / (across * across);
      }
    }
    return b0 * half_power(1 + square, slope);
  }
};

// Small-angle scatter of mirrors: BSDF = kappa theta^-n for theta >= above, theta = angle from the specular direction
// (docs/theory/surfaces.md, eq. 3.18). Below `above` the light belongs to the modes (minimum scatter angle, R2.31).
// Page: docs/reference/scatter/power-law.md.
struct PowerLaw : SampledByLobe<PowerLaw, ChordRings> {
  double kappa = 0;            // 1/sr, with theta in rad
  double exponent = 2;         // n
  double above = 5e-5;         // rad
  LobeTable<ChordRings> lobe;  // set by prepare()
  static constexpr char const* key = "power-law";
  static ModelKeys<PowerLaw> keys();
  ModelComplaint impossible() const;

  bool even_on_rings() const { return true; }  // host: value_at depends on r2 alone
  void prepare();                              // host

  STRAY_HD double value_at(Vec3, Vec3, double t2) const {
    double const theta2 = angle2_of_chord2(t2);
    return theta2 >= above * above ? kappa * half_power(theta2, -exponent) : 0;
  }
};

// Virgo's statistical 1/theta^2 law (docs/theory/surfaces.md, eq. 3.19, 3.20): a mirror scatters the total fraction
// `tis` with polar density kappa_s/theta^2 between `above` and pi/2; returns kappa_s (dimensionless), so kappa = tis
// kappa_s/(2 pi).
double statistical_kappa(double above);
// Integral of sin(t)/t^2 from a to b = [-sin t/t + Ci(t)]_a^b (eq. 3.20), angles in (0, pi].
double statistical_integral(double a, double b);

}  // namespace straytrace::optics
