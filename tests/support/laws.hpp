// SPDX-License-Identifier: BSD-3-Clause
// Prepared BSDF models in one line.
#pragma once

#include <cmath>
#include <vector>

#include "base/every_module.hpp"
#include "base/memory/storage.hpp"
#include "optics/scatter/mixture.hpp"

namespace straytrace::testing {

inline Lambertian lambertian(double reflectance) { return {reflectance}; }
inline PowerLaw power_law(double kappa, double exponent, double above) {
  PowerLaw law;
  law.kappa = kappa;
  law.exponent = exponent;
  law.above = above;
  law.prepare();
  return law;
}
inline Abg abg(double a, double b, double g) {
  Abg law;
  law.a = a;
  law.b = b;
  law.g = g;
  law.prepare();
  return law;
}

inline Harvey harvey(double b0, double l, double s, double across = 0) {
  Harvey law;
  law.b0 = b0;
  law.width = l;
  law.slope = s;
  law.across = across;
  law.prepare();
  return law;
}
inline Gaussian gaussian(double peak, double width) {
  Gaussian law;
  law.peak = peak;
  law.width = width;
  law.prepare();
  return law;
}
inline Polynomial polynomial(double c00, double c01, double c11, double peak, double width, double rise) {
  Polynomial law;
  law.c[0][0] = c00;
  law.c[0][1] = law.c[1][0] = c01;
  law.c[1][1] = c11;
  law.peak = peak;
  law.width = width;
  law.rise = rise;
  law.prepare();
  return law;
}

inline Microfacet microfacet(double roughness, double reflectance, double grazing) {
  Microfacet law;
  law.alpha = roughness;
  law.reflectance = reflectance;
  law.grazing = grazing;
  law.prepare();
  return law;
}
inline Grooves grooves(double across, double along, double reflectance, double grazing) {
  Grooves law;
  law.across = across;
  law.along = along;
  law.reflectance = reflectance;
  law.grazing = grazing;
  law.prepare();
  return law;
}

// Total of a moderately rough surface, eq. 3.10, second form.
inline double tis_moderate(double rms, double cos_i, double wavelength) {
  return -std::expm1(-tis_smooth(rms, cos_i, wavelength));
}

enum class Theory { rayleigh_rice, harvey_shack };
// k-correlation spectrum of this rms roughness over wavelength (infinite band), knee b in direction cosines: 1/b.
inline Roughness k_correlation(Theory theory, double rms, double b, double c, PolarisationFactor factor = {}) {
  Roughness law;
  law.a = rms * rms * (c - 1) * b * b / (2 * pi);
  law.b = b;
  law.c = c;
  law.harvey_shack = theory == Theory::harvey_shack;
  law.factor = factor;
  law.prepare();
  return law;
}
// Table of S2/lambda^4 = a rho^-m between two offsets, extended by its own slope.
inline Roughness tabulated(Theory theory, double a, double m, double first, double last, bool cut) {
  Roughness law;
  law.first = first;
  law.last = last;
  law.slope = -m;
  law.cut_above = cut;
  for (int i = 0; i < Roughness::points; ++i)
    law.log_value[i] = std::log(a) - m * (std::log(first) + std::log(last / first) * i / (Roughness::points - 1));
  law.harvey_shack = theory == Theory::harvey_shack;
  law.prepare();
  return law;
}
// Keeps what laws point to.
inline Storage& law_arrays() {
  static Storage all;
  return all;
}
inline Dust dust(double level, double reflectance, double index, double extinction) {
  Dust law;
  Cleanliness size;
  size.level = level;
  law.reflectance = reflectance;
  set_grains(law, grains(size, 60), 1.064e-6, index, extinction, law_arrays());
  law.prepare();
  return law;
}
// Harvey-like curves at three incidences, rising towards grazing.
inline Measured measured(double knee, double rise, Beyond beyond) {
  std::vector<MeasuredPoint> points;
  for (double degrees : {5.0, 30.0, 60.0})
    for (int i = 0; i < 30; ++i) {
      double const sine = std::sin(degrees * pi / 180), offset = 1e-3 * std::pow(1500, i / 29.0);
      points.push_back({sine, offset, 0.3 * (1 + rise * sine) * std::pow(1 + offset * offset / knee / knee, -1)});
    }
  Measured law;
  fit_measured(law, points, beyond);
  law.prepare();
  return law;
}

}  // namespace straytrace::testing
