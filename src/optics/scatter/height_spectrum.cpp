// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/height_spectrum.hpp"

#include <cmath>

#include "base/math/functions.hpp"

namespace straytrace {
namespace {

// Segment that holds f; the first and the last go on beyond the ends.
std::size_t segment(HeightSpectrum const& s, double f) {
  std::size_t low = 0, high = s.size() - 1;
  while (high - low > 1) {
    std::size_t const mid = (low + high) / 2;
    (s[mid].f <= f ? low : high) = mid;
  }
  return low;
}
double slope(HeightSpectrum const& s, std::size_t i) {
  return log_positive(s[i + 1].value / s[i].value) / log_positive(s[i + 1].f / s[i].f);
}

// Integral of value f^power from low to high, by midpoints even in ln(f), exact for power laws within a step.
double integral(HeightSpectrum const& s, double power, double low, double high) {
  constexpr int steps = 20000;
  double const ratio = log_positive(high / low) / steps;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    double const f = low * exp_number((i + 0.5) * ratio), m = slope(s, segment(s, f)) + power + 1, x = m * ratio / 2;
    double const within = x * x < 1e-12 ? 1 : (exp_number(x) - exp_number(-x)) / (2 * x);
    sum += spectrum_at(s, f) * power_positive(f, power + 1) * within;
  }
  return sum * ratio;
}

}  // namespace

double spectrum_at(HeightSpectrum const& s, double f) {
  std::size_t const i = segment(s, f);
  return s[i].value * power_positive(f / s[i].f, slope(s, i));
}

double variance_1d(HeightSpectrum const& s, double low, double high) { return 2 * integral(s, 0, low, high); }
double variance_2d(HeightSpectrum const& s, double low, double high) { return 2 * pi * integral(s, 1, low, high); }

HeightSpectrum surface_of_profile(HeightSpectrum const& profile) {
  // S2(f) = -(1/pi) int_f^inf S'(t)/sqrt(t^2 - f^2) dt with t = f cosh u
  constexpr int steps = 4000;
  constexpr double last = 14.5;  // t = 1e6 f
  HeightSpectrum surface;
  for (SpectrumPoint const& p : profile) {
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
      double const e = exp_number((k + 0.5) * last / steps), t = p.f * 0.5 * (e + 1 / e);
      sum -= slope(profile, segment(profile, t)) * spectrum_at(profile, t) / t;
    }
    surface.push_back({p.f, sum * last / steps / pi});
  }
  return surface;
}

double tis_smooth(double rms, double cos_i, double wavelength) {
  double const phase = 4 * pi * rms * cos_i / wavelength;
  return phase * phase;
}
double tis_moderate(double rms, double cos_i, double wavelength) {
  return -std::expm1(-tis_smooth(rms, cos_i, wavelength));
}

}  // namespace straytrace
