// SPDX-License-Identifier: BSD-3-Clause
// Scatter of a rough surface from its power spectrum of heights, by first-order perturbation (Rayleigh-Rice,
// docs/theory/surfaces.md, eq. 3.8) or generalised Harvey-Shack (eq. 3.11, 3.12). Lengths are in wavelengths: the
// spectrum is S2/lambda^4 against rho = |f| lambda = |alpha - alpha_0|. Pages: docs/reference/scatter/k-correlation.md,
// docs/reference/scatter/psd.md, docs/reference/scatter/harvey-shack.md.
#pragma once

#include "optics/lobes/lobe_table.hpp"
#include "optics/scatter/polarisation_factor.hpp"

namespace straytrace {

struct Roughness {
  // k-correlation (eq. 3.13): a/(1 + (b rho)^2)^((c+1)/2). With b = 0 the table: log(S2/lambda^4) at points evenly
  // spaced in log(rho); flat below it, `slope` in log-log above it, zero where cut.
  static constexpr int points = 256;
  double a = 0, b = 0, c = 0;
  double first = 1, last = 1, slope = 0, log_value[points] = {};
  std::int64_t cut_below = 0, cut_above = 0, harvey_shack = 0;  // flags; 64 bits leave no gaps in the fingerprint
  PolarisationFactor factor;
  // Harvey-Shack beyond first order: g = phase_variance (cos_i + cos_s)^2; the n-fold convolutions of the spectrum,
  // over n!, n = 2 ... orders.
  static constexpr int most_orders = 24, radii = 64;
  double phase_variance = 0;  // [2 pi sigma_rel/lambda]^2, of roughness up to rho = 1
  double first_radius = 1e-3, higher[most_orders + 1][radii] = {};
  std::int64_t orders = 1;
  LobeTable<OffsetRings> lobe;  // set by prepare()
  static constexpr char const* key = "k-correlation";

  void prepare();                                  // host: all below from the spectrum
  double variance(double low, double high) const;  // host: (sigma/lambda)^2 of rho from low to high, eq. 3.6

  STRAY_HD double spectrum(double rho) const {
    if (b > 0) return a * power_positive(1 + b * b * rho * rho, -(c + 1) / 2);
    if (rho < first) return cut_below ? 0 : exp_number(log_value[0]);
    if (rho > last) return cut_above ? 0 : exp_number(log_value[points - 1] + slope * log_positive(rho / last));
    double const x = (points - 1) * log_positive(rho / first) / log_positive(last / first);
    int const i = x < points - 1 ? static_cast<int>(x) : points - 2;
    return exp_number(log_value[i] + (x - i) * (log_value[i + 1] - log_value[i]));
  }
  // Sum over n >= 2 of g^n/n! times the n-fold convolution of the spectrum over its variance^n.
  STRAY_HD double higher_orders(double rho, double g) const {
    double const x =
        rho > first_radius ? (radii - 1) * log_positive(rho / first_radius) / log_positive(2 / first_radius) : 0;
    int const i = x < radii - 1 ? static_cast<int>(x) : radii - 2;
    double low = 0, high = 0;
    for (std::int64_t n = orders; n >= 2; --n) {
      low = (low + higher[n][i]) * g;
      high = (high + higher[n][i + 1]) * g;
    }
    low *= g;
    high *= g;
    return low > 0 && high > 0 ? low * power_positive(high / low, x - i < 1 ? x - i : 1) : 0;
  }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const rho = OffsetRings::of(wi, wo), q = factor.mean(wi, wo);
    if (!harvey_shack) return 16 * pi * pi * wi.z * wo.z * q * spectrum(rho);
    double const sum = wi.z + wo.z, g = phase_variance * sum * sum;
    double value = 4 * pi * pi * sum * sum * spectrum(rho);
    if (orders > 1) value += higher_orders(rho, g);
    return q * exp_number(-g) * value;
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

}  // namespace straytrace
