// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/coupling/band_coupling.hpp"
#include "base/errors.hpp"

namespace straytrace {
namespace {

std::size_t stretch_samples(EventSettings const& s) {
  double const step = double(s.welch.segment) * (1 - s.welch.overlap);
  return s.welch.segment + std::size_t(std::lround(double(s.averages - 1) * step));
}

// One stretch against the quiet spectrum.
LoudStretch compared(WelchSpectrum const& loud, WelchSpectrum const& quiet, EventSettings const& s, double least) {
  LoudStretch e;
  for (std::size_t k = 1; k + 1 < loud.hz.size(); ++k) {
    if (loud.hz[k] < s.low || loud.hz[k] > s.high || !(quiet.psd[k] > 0)) continue;
    double const sure =
        excess_significance({loud.psd[k], loud.effective_averages}, {quiet.psd[k], quiet.effective_averages});
    if (sure < least) continue;
    ++e.bins;
    if (sure <= e.significance) continue;
    e.significance = sure;
    e.hz = loud.hz[k];
    e.ratio = std::sqrt(loud.psd[k] / quiet.psd[k]);
  }
  return e;
}

}  // namespace

std::vector<LoudStretch> find_events(TimeSeries const& record, TimeSeries const& quiet, EventSettings const& s) {
  std::size_t const n = stretch_samples(s), stretches = record.samples.size() / n;
  if (stretches == 0)
    throw InputError(fmt::format("'{}' is shorter than {} averages, which take {:g} s", record.name, s.averages,
                                 double(n) / record.rate),
                     "choose fewer --averages or a shorter --segment");
  WelchSpectrum const still = welch(quiet.samples, quiet.rate, s.welch);
  auto const in_band = [&](double f) { return f >= s.low && f <= s.high; };
  double const looks = double(stretches) * double(std::max<std::ptrdiff_t>(
                                               1, std::count_if(still.hz.begin() + 1, still.hz.end(), in_band)));
  double const least = sigmas_of_probability(probability_of_sigmas(s.overall_significance) / looks);
  std::vector<LoudStretch> events;
  bool going_on = false;
  for (std::size_t i = 0; i < stretches; ++i) {
    std::span<double const> const part = std::span(record.samples).subspan(i * n, n);
    LoudStretch e = compared(welch(part, record.rate, s.welch), still, s, least);
    e.from = record.time(i * n);
    e.to = record.time((i + 1) * n);
    e.overall = sigmas_of_probability(std::min(1.0, probability_of_sigmas(e.significance) * looks));
    bool const passes = e.bins > 0;
    if (passes && going_on) {
      LoudStretch const before = events.back();
      if (before.significance >= e.significance) events.back().to = e.to;
      if (before.significance < e.significance) events.back() = e;
      events.back().from = before.from;
      events.back().bins = std::max(before.bins, e.bins);
    } else if (passes) {
      events.push_back(e);
    }
    going_on = passes;
  }
  return events;
}

}  // namespace straytrace
