// SPDX-License-Identifier: BSD-3-Clause
#include "signal/band_rms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "signal/filters.hpp"

namespace straytrace {

BandPower band_power(WelchSpectrum const& s, WelchSettings const& settings, double low, double high) {
  double const step = s.hz[1] - s.hz[0];
  if (!(low < high && high > 0 && low <= s.hz.back()))
    throw InputError(
        fmt::format("error: a band of {:g} Hz to {:g} Hz, where the spectrum has 0 to {:g} Hz\n  choose it inside", low,
                    high, s.hz.back()));
  BandPower out;
  double variance = 0;
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const from = std::max(0.0, s.hz[k] - step / 2),
                 to = s.is_real_line(k) && k > 0 ? s.hz[k] : s.hz[k] + step / 2;
    double const share = std::max(0.0, std::min(to, high) - std::max(from, low)) / (to - from);
    out.power += share * step * s.psd[k];
    variance += std::pow(share * step * s.sigma[k], 2);
  }
  double fourth = 0, second = 0;
  for (double const w : window_weights(settings.window, settings.window_parameter, settings.segment)) {
    second += w * w;
    fourth += w * w * w * w;
  }
  // Sum of the squared correlations between lines: the transform of w^2, by Parseval.
  double const shared = double(settings.segment) * fourth / (second * second);
  out.sigma = std::sqrt(variance * shared);
  return out;
}

double rms(std::span<double const> samples) {
  double sum = 0;
  for (double const x : samples) sum += x * x / double(samples.size());
  return std::sqrt(sum);
}

RmsTrend rms_trend(TimeSeries const& s, double low, double high, double stride) {
  auto const step = std::size_t(std::max(0.0, std::round(stride * s.rate)));
  if (step < 2 || step > s.samples.size())
    throw InputError(fmt::format(
        "error: strides of {:g} s for '{}' of {:g} s at {:g} Hz\n  choose them between two samples and the record",
        stride, s.name, s.duration(), s.rate));
  TimeSeries const band = band_passed(s, low, high);
  RmsTrend out;
  for (std::size_t i = 0; i + step <= band.samples.size(); i += step) {
    out.time.push_back(s.time(i) + double(step) / s.rate / 2);
    out.rms.push_back(rms(std::span(band.samples).subspan(i, step)));
    out.sigma.push_back(out.rms.back() / (2 * std::sqrt((high - low) * double(step) / s.rate)));
  }
  return out;
}

}  // namespace straytrace
