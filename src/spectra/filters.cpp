// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/filters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/sections.hpp"

namespace straytrace {
namespace {

constexpr double attenuation = 80;  // dB, of the anti-alias filter
constexpr double passed = 0.8;      // of the new Nyquist frequency

// Half of a symmetric low pass with unit gain at 0, from its centre on; `edge`: share of half the old rate where it is
// 6 dB down, `width` of the transition likewise (Kaiser 1974).
std::vector<double> low_pass(double edge, double width) {
  auto const half = std::size_t(std::ceil((attenuation - 7.95) / (2.285 * pi * width) / 2));
  double const beta = 0.1102 * (attenuation - 8.7), top = std::cyl_bessel_i(0, beta);
  std::vector<double> taps;
  double sum = 0;
  for (std::size_t i = 0; i <= half; ++i) {
    double const x = double(i), share = x / double(half + 1);
    double const sinc = i == 0 ? edge : std::sin(pi * edge * x) / (pi * x);
    taps.push_back(sinc * std::cyl_bessel_i(0, beta * std::sqrt(1 - share * share)) / top);
    sum += (i == 0 ? 1 : 2) * taps.back();
  }
  for (double& t : taps) t /= sum;
  return taps;
}

// Beyond its ends the record goes on by odd reflection: value and slope have no step.
double reflected(std::vector<double> const& x, std::ptrdiff_t i) {
  auto const last = std::ptrdiff_t(x.size()) - 1;
  if (i < 0) return 2 * x.front() - x[std::size_t(std::min(-i, last))];
  if (i > last) return 2 * x.back() - x[std::size_t(std::max<std::ptrdiff_t>(2 * last - i, 0))];
  return x[std::size_t(i)];
}

}  // namespace

TimeSeries decimated(TimeSeries const& s, std::size_t factor, std::size_t first) {
  if (factor == 0 || first >= s.samples.size())
    throw InputError(fmt::format("'{}' cannot be decimated by {}", s.name, factor), "the factor is at least 1");
  TimeSeries out{s.name, s.unit, s.time(first), s.rate / double(factor), {}};
  std::vector<double> const taps =
      factor == 1 ? std::vector<double>{1} : low_pass((1 + passed) / 2 / double(factor), (1 - passed) / double(factor));
  for (std::size_t i = first; i < s.samples.size(); i += factor) {
    double sum = taps[0] * s.samples[i];
    for (std::size_t j = 1; j < taps.size(); ++j) {
      auto const at = std::ptrdiff_t(i), step = std::ptrdiff_t(j);
      sum += taps[j] * (reflected(s.samples, at - step) + reflected(s.samples, at + step));
    }
    out.samples.push_back(sum);
  }
  return out;
}

TimeSeries band_passed(TimeSeries const& s, double low_hz, double high_hz, int order) {
  double const nyquist = s.rate / 2;
  if (!(low_hz >= 0 && low_hz < high_hz && high_hz <= nyquist))
    throw InputError(fmt::format("a band of {:g} Hz to {:g} Hz for '{}'", low_hz, high_hz, s.name),
                     fmt::format("choose it between 0 and {:g} Hz, half the sample rate", nyquist));
  if (low_hz == 0 && high_hz == nyquist) return s;
  TimeSeries out = s;
  out.samples = both_ways(butterworth(order, low_hz / nyquist, high_hz / nyquist), s.samples);
  return out;
}

TimeSeries notched(TimeSeries const& s, double hz, double quality) {
  if (!(hz > 0 && hz < s.rate / 2 && quality > 0))
    throw InputError(fmt::format("a notch at {:g} Hz with Q {:g} for '{}'", hz, quality, s.name),
                     fmt::format("choose it between 0 and {:g} Hz, half the sample rate", s.rate / 2));
  TimeSeries out = s;
  out.samples = both_ways({notch(2 * hz / s.rate, quality)}, s.samples);
  return out;
}

}  // namespace straytrace
