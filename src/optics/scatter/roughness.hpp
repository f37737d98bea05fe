// SPDX-License-Identifier: BSD-3-Clause
// Scatter of rough surfaces from the power spectrum of their heights (docs/theory/surfaces.md, eq. 3.5 to 3.13). Pages:
// docs/reference/scatter/k-correlation.md, docs/reference/scatter/psd.md, docs/reference/scatter/harvey-shack.md.
#pragma once

#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/storage.hpp"
#include "optics/coating/film.hpp"
#include "optics/lobes/lobe_table.hpp"

namespace straytrace::optics {

// Factor Q of roughness scatter from all interfaces of a thin-film stack in vacuum, first order in their heights
// (docs/theory/surfaces.md, eq. 3.29 to 3.31). Page: docs/reference/scatter/interfaces.md.

// At one interface, for a wave of unit amplitude from the vacuum, over 2 cos and times the root of the step of the
// permittivity: the field s across the plane of incidence; for p the field along the surface, and the displacement
// across it over sin and over the root of both permittivities.
struct InterfaceField {
  Complex s, along, across;
};

// Sums over interfaces for one pair of directions.
struct StackSum {
  Complex ss, sp, ps, cc, zz;         // of heights in common
  double a = 0, b = 0, c = 0, d = 0;  // of independent heights

  STRAY_HD void add(InterfaceField const& in, InterfaceField const& out, double sines) {
    Complex const one[] = {in.s * out.s, in.s * out.along, in.along * out.s, in.along * out.along,
                           sines * (in.across * out.across)};
    a += norm(one[0]) + norm(one[3]);
    b += norm(one[1]) + norm(one[2]);
    c += one[3].re * one[4].re + one[3].im * one[4].im;
    d += norm(one[4]);
    ss = ss + one[0], sp = sp + one[1], ps = ps + one[2], cc = cc + one[3], zz = zz + one[4];
  }
  // Q, the mean over the incident and the sum over the outgoing polarisations. phi: azimuth between the plane of
  // incidence and that of scatter, 0 forward. `common`: share of the height spectrum that all interfaces have in
  // common.
  STRAY_HD double factor(double cos_phi, double common) const {
    double const square = cos_phi * cos_phi, rest = std::fmax(0.0, 1 - square);
    double const together = square * norm(ss) + norm(cos_phi * cc - zz) + rest * (norm(sp) + norm(ps));
    double const apart = square * a + rest * b - 2 * cos_phi * c + d;
    return 0.5 * std::fmax(0.0, common * together + (1 - common) * apart);
  }
};

STRAY_HD double cos_of_azimuth(Vec3 wi, Vec3 wo, double sines) {
  return sines > 1e-12 ? -(wi.x * wo.x + wi.y * wo.y) / sines : 1;
}

// The fields in a table, even in the cosine from 0 to 1, by Lagrange's cubic.
struct StackFactor {
  View<InterfaceField const> table;  // interfaces of node 0, then of node 1 ...; none: no stack
  std::int64_t nodes = 0, interfaces = 0;
  double common = 1;

  STRAY_HD double mean(Vec3 wi, Vec3 wo) const {
    double const sines = std::sqrt((wi.x * wi.x + wi.y * wi.y) * (wo.x * wo.x + wo.y * wo.y));
    Row const in(*this, wi.z), out(*this, wo.z);
    StackSum sum;
    for (std::int64_t j = 0; j < interfaces; ++j) sum.add(in.at(j), out.at(j), sines);
    return sum.factor(cos_of_azimuth(wi, wo, sines), common);
  }

  struct Row {
    InterfaceField const* first;
    std::int64_t step;
    double weight[4];

    STRAY_HD Row(StackFactor const& f, double cosine) : step(f.interfaces) {
      double const x = cosine * double(f.nodes - 1);
      std::int64_t const left = static_cast<std::int64_t>(x) - 1, last = f.nodes - 4,
                         from = left < 0      ? 0
                                : left > last ? last
                                              : left;
      double const y = x - double(from);
      weight[0] = -(y - 1) * (y - 2) * (y - 3) / 6;
      weight[1] = y * (y - 2) * (y - 3) / 2;
      weight[2] = -y * (y - 1) * (y - 3) / 2;
      weight[3] = y * (y - 1) * (y - 2) / 6;
      first = f.table.data + from * step;
    }
    STRAY_HD InterfaceField at(std::int64_t j) const {
      InterfaceField sum;
      for (int i = 0; i < 4; ++i) {
        InterfaceField const& f = first[i * step + j];
        sum.s = sum.s + weight[i] * f.s;
        sum.along = sum.along + weight[i] * f.along;
        sum.across = sum.across + weight[i] * f.across;
      }
      return sum;
    }
  };
};

// What one stack scatters, host only. `behind`: index of the body behind it, n + i k.
struct RoughStack {
  std::vector<FilmLayer> layers;  // from the front inwards
  Complex behind;
  double wavelength = 1.064e-6;  // m, vacuum
  double common = 1;             // share of the height spectrum that all interfaces have in common

  std::vector<InterfaceField> fields(double cosine) const;
  double factor(double cos_i, double cos_s, double cos_phi) const;  // Q without a table
  // Halves the step of the table until fields are right to 1e-3 of their largest; 8193 nodes at most.
  StackFactor tabulated(Storage&) const;

 private:
  Complex permittivity(std::size_t medium) const;  // 0: vacuum; then the layers; then the body
  std::vector<InterfaceField> nodes(std::int64_t count) const;
};

// Polarisation factors Q of roughness scatter from one interface (eq. 3.9): relative permittivity eps, or a constant
// reflectance for a coated mirror.
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

// First-order perturbation (Rayleigh-Rice, eq. 3.8) or generalised Harvey-Shack (eq. 3.11, 3.12). Lengths are in
// wavelengths: the spectrum is S2/lambda^4 against rho = |f| lambda = |alpha - alpha_0|.
struct Roughness : SampledByLobe<Roughness, OffsetRings> {
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
  StackFactor stack;            // instead of `factor`, of a coating with rough interfaces; the last member: fingerprint
  static constexpr char const* key = "k-correlation";

  void prepare();                                  // host: all below from the spectrum
  double variance(double low, double high) const;  // host: (sigma/lambda)^2 of rho from low to high, eq. 3.6

  STRAY_HD double spectrum(double rho) const {
    if (b > 0) return a * half_power(1 + b * b * rho * rho, -(c + 1));
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
  STRAY_HD double value_at(Vec3 wi, Vec3 wo, double r2) const {
    double const rho = std::sqrt(r2);
    double const q = stack.table.size > 0 ? stack.mean(wi, wo) : factor.mean(wi, wo);
    if (!harvey_shack) return 16 * pi * pi * wi.z * wo.z * q * spectrum(rho);
    double const sum = wi.z + wo.z, g = phase_variance * sum * sum;
    double value = 4 * pi * pi * sum * sum * spectrum(rho);
    if (orders > 1) value += higher_orders(rho, g);
    return q * exp_number(-g) * value;
  }
};

double tis_smooth(double rms, double cos_i, double wavelength);  // eq. 3.10, first form

// Power spectra of heights as points, host only.

// Two-sided spectra as power laws between points: 1D in m^3, 2D in m^4; f in 1/m, increasing.
struct SpectrumPoint {
  double f, value;
};
using HeightSpectrum = std::vector<SpectrumPoint>;

double spectrum_at(HeightSpectrum const&, double f);                 // extended by the end slopes
double variance_1d(HeightSpectrum const&, double low, double high);  // m^2, eq. 3.5
double variance_2d(HeightSpectrum const&, double low, double high);  // m^2, eq. 3.6
// 2D spectrum of an isotropic surface from its profile spectrum: the inverse Abel transform, for power laws eq. 3.7.
// Values come out at or below zero where no isotropic surface has such a profile.
HeightSpectrum surface_of_profile(HeightSpectrum const&);

}  // namespace straytrace::optics
