// SPDX-License-Identifier: BSD-3-Clause
#include "signal/interpolate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/message.hpp"

namespace straytrace {
namespace {

constexpr int half = 16, steps = 512;  // taps on either side; rows of the kernel between two samples

double kaiser(double x) {  // |x| <= 1
  constexpr double beta = 9;
  return std::cyl_bessel_i(0, beta * std::sqrt(std::max(0.0, 1 - x * x))) / std::cyl_bessel_i(0, beta);
}

// Row s: weights of the samples -15 ... 16 around a point s/steps behind a sample; they sum to 1, so that a constant
// stays one.
using Row = std::array<double, 2 * half>;
std::vector<Row> const& kernel() {
  static std::vector<Row> const rows = [] {
    std::vector<Row> all(steps + 1);
    for (int s = 0; s <= steps; ++s) {
      double const at = double(s) / steps;
      double sum = 0;
      for (int j = 0; j < 2 * half; ++j) {
        double const x = at - (j - half + 1);
        all[s][j] = (std::fabs(x) < 1e-12 ? 1 : std::sin(pi * x) / (pi * x)) * kaiser(x / half);
        if ((s == 0 || s == steps) && std::fabs(x) > 0.5) all[s][j] = 0;
        sum += all[s][j];
      }
      for (double& w : all[s]) w /= sum;
    }
    return all;
  }();
  return rows;
}

// Point reflection at the ends keeps value and slope.
double sample(std::vector<double> const& x, std::ptrdiff_t i) {
  auto const last = std::ptrdiff_t(x.size()) - 1;
  if (i < 0) return 2 * x.front() - x[std::size_t(std::min(-i, last))];
  if (i > last) return 2 * x.back() - x[std::size_t(std::max<std::ptrdiff_t>(2 * last - i, 0))];
  return x[std::size_t(i)];
}

double between(TimeSeries const& series, double place) {
  double const whole = std::floor(place), row = (place - whole) * steps;
  auto const low = std::size_t(row);
  double const share = row - double(low);
  Row const &a = kernel()[low], &b = kernel()[std::min<std::size_t>(low + 1, steps)];
  auto const first = std::ptrdiff_t(whole) - half + 1;
  double sum = 0;
  bool const inside = first >= 0 && first + 2 * half <= std::ptrdiff_t(series.samples.size());
  for (int j = 0; j < 2 * half; ++j)
    sum += (a[j] + share * (b[j] - a[j])) *
           (inside ? series.samples[std::size_t(first + j)] : sample(series.samples, first + j));
  return sum;
}

}  // namespace

std::vector<double> interpolated(TimeSeries const& series, double first, double rate, std::size_t count) {
  double const begin = (first - series.start) * series.rate, step = series.rate / rate;
  double const end = begin + step * double(count ? count - 1 : 0);
  if (series.samples.empty() || begin < -half || end > double(series.samples.size()) - 1 + half)
    throw InputError(
        fmt::format("error: '{}' has samples from GPS {:.3f} to {:.3f}, not from {:.3f} to {:.3f}\n  choose a span "
                    "that it covers",
                    series.name, series.start, series.end(), first, first + double(count) / rate));
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    double const place = begin + step * double(i), near = std::round(place);
    // GPS times are good to 0.2 us: what is that close to a sample is meant to be it.
    bool const on = std::fabs(place - near) < 1e-6 + 2.5e-7 * series.rate;
    values[i] = on ? sample(series.samples, std::ptrdiff_t(near)) : between(series, place);
  }
  return values;
}

}  // namespace straytrace
