// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/cross_spectra.hpp"

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/segments.hpp"

namespace straytrace {

CrossSpectra cross_spectra(std::span<double const> x, std::span<double const> y, double rate, WelchSettings const& s) {
  if (x.size() != y.size())
    throw InputError(fmt::format("records of {} and {} samples", x.size(), y.size()), "cut both to the same stretch");
  if (s.average != Average::mean) throw InputError("cross spectra are averaged by their mean", "write --average mean");
  Segments of_x(x.size(), rate, s), of_y(y.size(), rate, s);
  CrossSpectra out;
  out.segments = of_x.count();
  out.effective_averages = of_x.effective();
  out.noise_bandwidth = of_x.noise_bandwidth();
  std::size_t const lines = of_x.lines();
  out.input.assign(lines, 0);
  out.output.assign(lines, 0);
  out.cross.assign(lines, 0);
  for (std::size_t i = 0; i < out.segments; ++i) {
    Complexes const &a = of_x.transform(x, i), &b = of_y.transform(y, i);
    for (std::size_t k = 0; k < lines; ++k) {
      out.input[k] += std::norm(a[k]);
      out.output[k] += std::norm(b[k]);
      out.cross[k] += std::conj(a[k]) * b[k];
    }
  }
  for (std::size_t k = 0; k < lines; ++k) {
    double const scale = of_x.density(k) / double(out.segments);
    out.hz.push_back(of_x.hz(k));
    out.input[k] *= scale;
    out.output[k] *= scale;
    out.cross[k] *= scale;
  }
  return out;
}

CrossSpectra cross_spectra(TimeSeries const& x, TimeSeries const& y, WelchSettings const& s) {
  std::vector<TimeSeries> const both = aligned({x, y});
  return cross_spectra(both[0].samples, both[1].samples, both[0].rate, s);
}

std::vector<double> coherence(CrossSpectra const& s) {
  std::vector<double> c;
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const powers = s.input[k] * s.output[k];
    c.push_back(powers > 0 ? std::min(1.0, std::norm(s.cross[k]) / powers) : not_a_number);
  }
  return c;
}

double coherence_level(double n, double probability) {
  if (!(probability > 0 && probability < 1))
    throw InputError(fmt::format("a significance of {:g} is not between 0 and 1", probability),
                     "write for example 0.05");
  return n > 1 ? 1 - std::pow(probability, 1 / (n - 1)) : 1;
}

double confidence_radius(double c, double n, double probability) {
  if (!(n > 1 && c > 0)) return infinity;
  return std::sqrt((std::pow(1 - probability, -1 / (n - 1)) - 1) * std::max(0.0, 1 - c) / c);
}

Interval coherence_interval(std::span<double const> c, double n, double probability) {
  Interval out;
  double const z = n > 1 ? quantile(boost::math::normal(), (1 + probability) / 2) / std::sqrt(2 * (n - 1)) : infinity;
  for (double const value : c) {
    double const w = std::atanh(std::min(std::sqrt(value), 1 - 1e-15));
    out.low.push_back(std::pow(std::tanh(std::max(0.0, w - z)), 2));
    out.high.push_back(std::pow(std::tanh(w + z), 2));
  }
  return out;
}

namespace {

TransferEstimate estimate(CrossSpectra const& s, bool first) {
  TransferEstimate t{s.hz, {}, {}, {}, coherence(s), s.effective_averages};
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    std::complex<double> const h = first ? s.cross[k] / s.input[k] : s.output[k] / std::conj(s.cross[k]);
    double const c = t.coherence[k], relative = std::sqrt((1 - c) / (2 * c * s.effective_averages));
    t.value.push_back(h);
    t.modulus_sigma.push_back(std::abs(h) * relative);
    t.phase_sigma.push_back(std::isnan(relative) ? relative : std::min(relative, pi / std::sqrt(3.0)));
  }
  return t;
}

}  // namespace

TransferEstimate h1(CrossSpectra const& s) { return estimate(s, true); }
TransferEstimate h2(CrossSpectra const& s) { return estimate(s, false); }

}  // namespace straytrace
