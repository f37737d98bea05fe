// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/filters.hpp"

namespace straytrace::spectra {
namespace {

constexpr double sample_slack = 0.02;  // share of a sample by which clocks may disagree: 0.2 us of GPS, and rounding

std::string span_text(TimeSeries const& s) { return fmt::format("{}..{}", gps_text(s.start), gps_text(s.end())); }

// Whole number of samples of `s` between its start and `time`; NaN when `time` is between two samples.
double whole_steps(TimeSeries const& s, double time) {
  double const steps = (time - s.start) * s.rate, whole = std::round(steps);
  return std::abs(steps - whole) < std::max(sample_slack, 4e-7 * s.rate) && std::abs(steps - whole) < 0.3 ? whole : NAN;
}

TimeSeries part(TimeSeries const& s, std::size_t first, std::size_t last) {
  TimeSeries out{s.name, s.unit, s.time(first), s.rate, {}};
  out.samples.assign(s.samples.begin() + std::ptrdiff_t(first), s.samples.begin() + std::ptrdiff_t(last));
  return out;
}

std::size_t factor_between(TimeSeries const& fast, TimeSeries const& slow) {
  double const ratio = fast.rate / slow.rate, factor = std::round(ratio);
  if (std::abs(ratio - factor) > 1e-9 * ratio)
    throw InputError(fmt::format("the sample rates of '{}', {:g} Hz, and '{}', {:g} Hz, are not in a whole ratio",
                                 fast.name, fast.rate, slow.name, slow.rate),
                     "resample one of them first");
  return std::size_t(factor);
}

}  // namespace

TimeSeries cut(TimeSeries const& s, GpsSpan span) {
  double const slack = sample_slack / s.rate + 4e-7;
  bool const inside = span.from < span.to && (span.from <= -1e300 || span.from >= s.start - slack) &&
                      (span.to >= 1e300 || span.to <= s.end() + slack) && span.from < s.end() && span.to > s.start;
  if (!inside)
    throw InputError(fmt::format("'{}' covers GPS {}, not the requested {}..{}", s.name, span_text(s),
                                 span.from <= -1e300 ? "its start" : gps_text(span.from),
                                 span.to >= 1e300 ? "its end" : gps_text(span.to)),
                     "choose a span inside it, with --gps A..B or the option that names the stretch");
  double const count = double(s.samples.size());
  double const from = std::ceil((std::max(span.from, s.start) - s.start) * s.rate - s.rate * slack);
  double const to = std::ceil((std::min(span.to, s.end()) - s.start) * s.rate - s.rate * slack);
  auto const first = std::size_t(std::clamp(from, 0.0, count)), last = std::size_t(std::clamp(to, 0.0, count));
  if (last < first + 2)
    throw InputError(fmt::format("GPS {}..{} contains fewer than two samples of '{}', sampled at {:g} Hz",
                                 gps_text(span.from), gps_text(span.to), s.name, s.rate),
                     "choose a longer span");
  return part(s, first, last);
}

std::vector<TimeSeries> aligned(std::vector<TimeSeries> const& all) {
  if (all.size() < 2) return all;
  TimeSeries const& slow = *std::ranges::min_element(all, [](auto const& a, auto const& b) { return a.rate < b.rate; });
  double from = -1e300, to = 1e300;
  for (TimeSeries const& s : all) {
    from = std::max(from, s.start);
    to = std::min(to, s.end());
  }
  double const first = std::ceil((from - slow.start) * slow.rate - sample_slack);
  double const start = slow.start + first / slow.rate;
  if (to - start < 2 / slow.rate) {
    std::string spans;
    for (TimeSeries const& s : all) spans += fmt::format("\n  '{}': GPS {}", s.name, span_text(s));
    throw InputError("the series have no stretch in common", "choose records of the same time" + spans);
  }
  auto const count = std::size_t(std::floor((to - start) * slow.rate + sample_slack));
  std::vector<TimeSeries> out;
  for (TimeSeries const& s : all) {
    std::size_t const factor = factor_between(s, slow);
    double const steps = whole_steps(s, start);
    if (std::isnan(steps))
      throw InputError(fmt::format("the samples of '{}' lie between those of '{}'", s.name, slow.name),
                       "resample one record to the times of the other");
    TimeSeries const same = factor == 1 ? s : decimated(s, factor, std::size_t(steps) % factor);
    out.push_back(part(same, std::size_t(steps) / factor, std::size_t(steps) / factor + count));
    out.back().start = start;
    out.back().rate = slow.rate;
  }
  return out;
}

namespace {

constexpr int half = 16, steps = 512;  // taps on either side; rows of the kernel between two samples

double kaiser(double x) {  // |x| <= 1
  constexpr double beta = 9;
  return std::cyl_bessel_i(0, beta * std::sqrt(std::max(0.0, 1 - x * x))) / std::cyl_bessel_i(0, beta);
}

// Row s: weights of the samples -15 ... 16 around a point s/steps behind a sample; they sum to 1, so that a constant
// stays constant.
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
    throw InputError(fmt::format("'{}' has samples from GPS {:.3f} to {:.3f}, not from {:.3f} to {:.3f}", series.name,
                                 series.start, series.end(), first, first + double(count) / rate),
                     "choose a span that it covers");
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    double const place = begin + step * double(i), near = std::round(place);
    // GPS times have a resolution of 0.2 us: times that close to a sample mean the sample.
    bool const on = std::fabs(place - near) < 1e-6 + 2.5e-7 * series.rate;
    values[i] = on ? sample(series.samples, std::ptrdiff_t(near)) : between(series, place);
  }
  return values;
}

}  // namespace straytrace::spectra
