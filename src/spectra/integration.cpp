// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/integration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/filters.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::spectra {
namespace {

// In SI, with the unit after `times` integrations.
TimeSeries prepared(TimeSeries const& s, int times, double corner) {
  auto const unit = parse_unit(s.unit);
  auto const seconds = power_of(dim::time, times);
  auto const after = unit && seconds ? straytrace::times(unit->dimension, *seconds) : std::nullopt;
  if (times < 0 || times > 2 || !after)
    throw InputError(fmt::format("'{}' in {} cannot be integrated {} times", s.name, s.unit, times),
                     "give its unit with --unit, for example m/s^2");
  if (!(corner > 0 && corner < s.rate / 4))
    throw InputError(fmt::format("a high pass at {:g} Hz for '{}', sampled at {:g} Hz", corner, s.name, s.rate),
                     "choose it above 0 and below a quarter of the sample rate");
  TimeSeries out = s;
  out.unit = example_unit(*after);
  if (out.unit.empty()) out.unit = "1";
  for (double& x : out.samples) x = to_si(x, *unit);
  return out;
}

}  // namespace

std::optional<int> integrations_to(Dimension to, std::string const& unit) {
  auto const from = parse_unit(unit);
  for (int n = 0; from && n <= 2; ++n)
    if (auto const reached = times(from->dimension, *power_of(dim::time, n)); reached && *reached == to) return n;
  return {};
}

int integrations_to_displacement(std::string const& unit) {
  if (auto const times = integrations_to(dim::length, unit)) return *times;
  throw InputError(
      fmt::format("'{}' is not a unit of displacement, velocity or acceleration", unit),
      "give the unit with --unit or --witness-unit: m, m/s, m/s^2; calibrate counts or volts with the value of "
      "one, \"2e-6 m/s^2\"");
}

double integrated_asd(double asd, double hz, int times) { return asd / std::pow(2 * pi * hz, times); }

TimeSeries integrated(TimeSeries const& s, int times, double corner) {
  TimeSeries out = prepared(s, times, corner);
  double const mean = std::accumulate(out.samples.begin(), out.samples.end(), 0.0) / double(out.samples.size());
  for (double& x : out.samples) x -= mean;
  out.samples = filtered(out.samples, std::size_t(std::ceil(3 * s.rate / corner)), [&](double cycles) {
    double const f = cycles * s.rate, ratio = std::pow(f / corner, 4);
    return f == 0 ? 0 : ratio / (1 + ratio) / std::pow(std::complex<double>(0, 2 * pi * f), times);
  });
  return out;
}

TimeSeries settled(TimeSeries const& s, double corner) {
  if (s.duration() * corner < 6)
    throw InputError(
        fmt::format("--corner: '{}' lasts {:.3g} s, fewer than six periods of {:g} Hz", s.name, s.duration(), corner),
        "give a longer record or a higher corner");
  return cut(s, {s.start + 2 / corner, s.end() - 2 / corner});
}

double rms_below(TimeSeries const& s, int times, double corner) {
  double const lower = corner / 2;
  if (s.duration() * lower < 6) return not_a_number;
  TimeSeries const all = settled(integrated(s, times, lower), lower),
                   kept = cut(integrated(s, times, corner), {all.start, all.end()});
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    double const lost = all.samples[i] - kept.samples[i];
    sum += lost;
    squares += lost * lost;
  }
  double const n = double(all.samples.size());
  return std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0));
}

TimeSeries integrated_causal(TimeSeries const& s, int times, double corner) {
  TimeSeries out = prepared(s, times, corner);
  out.samples = once(butterworth(2 * times + 2, 2 * corner / s.rate, 1), std::move(out.samples));
  for (int i = 0; i < times; ++i) {
    double sum = 0, before = 0;
    for (double& x : out.samples) {
      sum += (before + x) / 2 / s.rate;
      before = x;
      x = sum;
    }
  }
  return out;
}

}  // namespace straytrace::spectra
