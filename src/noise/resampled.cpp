// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/message.hpp"
#include "noise/motion_series.hpp"

namespace straytrace {
namespace {

constexpr double half_width = 32;  // samples of the slower clock
constexpr double beta = 9;         // of the Kaiser window: what is left of other bands is below 1e-4 in amplitude

double kaiser(double u) { return u * u < 1 ? std::cyl_bessel_i(0, beta * std::sqrt(1 - u * u)) : 0; }

double sinc(double x) { return std::fabs(x) < 1e-9 ? 1 : std::sin(pi * x) / (pi * x); }

// Beyond the ends the series goes on as its point reflection there: value and slope are continuous.
double sample(std::vector<double> const& x, std::ptrdiff_t i) {
  auto const last = static_cast<std::ptrdiff_t>(x.size()) - 1;
  if (i < 0) return 2 * x.front() - x[static_cast<std::size_t>(std::min(-i, last))];
  if (i > last) return 2 * x.back() - x[static_cast<std::size_t>(std::max<std::ptrdiff_t>(2 * last - i, 0))];
  return x[static_cast<std::size_t>(i)];
}

}  // namespace

std::vector<double> resampled(TimeSeries const& series, SampleTimes const& times) {
  double const early = (times.start - series.start) * series.rate, step = series.rate / times.rate;
  double const late = early + step * static_cast<double>(times.samples - 1);
  if (series.samples.size() < 2 || early < -1e-3 || late > static_cast<double>(series.samples.size()) + 1e-3)
    throw InputError(fmt::format(
        "error: '{}' holds GPS {:.3f} to {:.3f}, not all of {:.3f} to {:.3f}\n  choose a shorter or another "
        "stretch of time",
        series.name, series.start, series.end(), times.start, times.start + times.duration()));
  std::vector<double> out(times.samples);
  double const cut = std::min(1.0, 1 / step);  // of the half rate of the recording
  double const reach = half_width / cut, norm = kaiser(0);
  for (std::size_t i = 0; i < times.samples; ++i) {
    double const at = early + step * static_cast<double>(i), nearest = std::round(at);
    if (step == 1 && std::fabs(at - nearest) < 1e-6) {
      out[i] = sample(series.samples, static_cast<std::ptrdiff_t>(nearest));
      continue;
    }
    double sum = 0, weights = 0;
    for (auto k = static_cast<std::ptrdiff_t>(std::ceil(at - reach)); static_cast<double>(k) <= at + reach; ++k) {
      double const d = at - static_cast<double>(k), w = sinc(cut * d) * kaiser(d / reach) / norm;
      sum += w * sample(series.samples, k);
      weights += w;
    }
    out[i] = sum / weights;
  }
  return out;
}

}  // namespace straytrace
