// SPDX-License-Identifier: BSD-3-Clause
// The fitted noise as a series.
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "base/functions.hpp"
#include "commission/fringe_search.hpp"
#include "signal/interpolate.hpp"

namespace straytrace {
namespace {

using Field = std::vector<std::complex<double>>;

std::size_t power_of_two_above(std::size_t n) {
  std::size_t p = 1;
  while (p < n) p *= 2;
  return p;
}

struct Span {
  double start = 0;  // GPS s
  std::size_t first = 0, count = 0;
};

Span span_of(FringeRecords const& r, FringeFit const& fit) {
  double delay = 0;
  for (FittedPath const& p : fit.paths) delay = std::max(delay, std::fabs(p.delay.value));
  SampleSpan const span = covered(r, delay);
  return {r.target.time(span.from), span.from, span.to - span.from};
}

// exp(i(phi + theta)) of one path, times sqrt(f_r).
void add_field(Field& field, FringeRecords const& r, FringeFit const& fit, FittedPath const& p, Span const& span,
               double wavelength) {
  std::vector<double> u(span.count, 0.0);
  for (std::size_t w = 0; w < r.witnesses.size(); ++w) {
    auto const x = interpolated(r.witnesses[w], span.start - p.delay.value, r.target.rate, span.count);
    for (std::size_t i = 0; i < span.count; ++i) u[i] += (w ? -fit.ratio.value : 1) * (x[i] - fit.means[w]);
  }
  for (std::size_t i = 0; i < span.count; ++i) {
    double const t = span.start - fit.middle + double(i) / r.target.rate;
    double const phase = p.phase.value + 4 * pi * p.multiplicity.value * u[i] / wavelength + p.drift.value * t;
    SinCos const turn = sincos_turn(phase / (2 * pi));
    field[i] += p.amplitude.value * std::complex<double>(turn.cos, turn.sin);
  }
}

double mask(double hz, double low, double high) {
  double const inside = std::min(hz - low, high - hz) / (0.05 * (high - low));
  return inside <= 0 ? 0 : inside >= 1 ? 1 : 0.5 - 0.5 * std::cos(pi * inside);
}

}  // namespace

FringeModel fringe_model(FringeRecords const& r, FringeFitSettings const& s, FringeFit const& fit) {
  Span const span = span_of(r, fit);
  // Room behind the end, so that the filter does not wrap into the beginning.
  std::size_t const n = power_of_two_above(span.count + std::size_t(2 * r.target.rate));
  Field sum(n), lines, series;
  Eigen::FFT<double> fft;
  for (std::size_t p = 0; p < fit.paths.size(); ++p) {
    Field field(n);
    add_field(field, r, fit, fit.paths[p], span, s.wavelength);
    fft.fwd(lines, field);
    for (std::size_t k = 1; k < n / 2; ++k) {
      double const hz = double(k) * r.target.rate / double(n), m = mask(hz, s.low, s.high);
      if (m == 0) continue;
      std::complex<double> const above = lines[k], below = std::conj(lines[n - k]);
      std::complex<double> const real = 0.5 * (above + below),
                                 imaginary = std::complex<double>(0, -0.5) * (above - below);
      FringePath const& path = s.paths[p];
      std::complex<double> const phase = path.phase ? std::conj(path.phase(hz)) : 1;
      std::complex<double> const amplitude = path.amplitude ? std::conj(path.amplitude(hz)) : 0;
      sum[k] += m * (phase * imaginary + amplitude * real);
    }
  }
  fft.inv(series, sum);
  FringeModel out{span.first, {}};
  for (std::size_t i = 0; i < span.count; ++i) out.values.push_back(2 * series[i].real());
  return out;
}

}  // namespace straytrace
