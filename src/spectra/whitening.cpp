// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/whitening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/fourier.hpp"

namespace straytrace {
namespace {

// Without its mean, with both ends brought to zero over so many samples: a step there would drown the faint lines.
std::vector<double> faded(std::vector<double> x, std::size_t length) {
  double const mean = std::accumulate(x.begin(), x.end(), 0.0) / double(x.size());
  for (double& v : x) v -= mean;
  for (std::size_t i = 0; i < std::min(length, x.size() / 2); ++i) {
    double const share = std::pow(std::sin(pi / 2 * (double(i) + 0.5) / double(length)), 2);
    x[i] *= share;
    x[x.size() - 1 - i] *= share;
  }
  return x;
}

}  // namespace

TimeSeries whitened(TimeSeries const& s, WelchSettings const& settings) {
  WelchSpectrum const spectrum = welch(s.samples, s.rate, settings);
  double const step = spectrum.hz[1];
  if (std::any_of(spectrum.psd.begin() + 1, spectrum.psd.end(), [](double p) { return !(p > 0); }))
    throw InputError(fmt::format("'{}' has no power at some frequencies, so it cannot be whitened", s.name),
                     "choose a stretch with signal");
  TimeSeries out = s;
  out.unit = "1";
  out.samples = filtered(faded(s.samples, settings.segment / 2), 0, [&](double cycles) -> std::complex<double> {
    double const f = cycles * s.rate, line = f / step;
    if (line < 1) return 0;
    auto const k = std::min(std::size_t(line), spectrum.psd.size() - 2);
    bool const doubled = spectrum.is_real_line(k + 1);  // the last line is not; its neighbour below is
    double const last = spectrum.psd[k + 1] * (doubled ? 2 : 1);
    double const asd = std::lerp(std::sqrt(spectrum.psd[k]), std::sqrt(last), std::min(1.0, line - double(k)));
    return std::sqrt(2 / s.rate) / asd;
  });
  return out;
}

}  // namespace straytrace
