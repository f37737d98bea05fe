// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/curve.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/math/constants.hpp"
#include "base/text/words.hpp"
#include "io/delimited_text.hpp"
#include "spectra/filters.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::spectra {

double log_log_at(std::span<double const> hz, std::span<double const> value, double f) {
  if (hz.empty() || !(f >= hz.front() && f <= hz.back())) return not_a_number;
  if (hz.size() == 1) return value.front();
  auto const last = static_cast<std::ptrdiff_t>(hz.size()) - 1;
  auto const i =
      static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(hz, f) - hz.begin(), 1, last));
  double const low = value[i - 1], high = value[i];
  if (f == hz[i - 1] || f == hz[i]) return f == hz[i] ? high : low;
  double const x = log_share(f, hz[i - 1], hz[i]);
  if (low == 0 || high == 0) return low + (high - low) * x;  // a power law has no zeros
  return log_log_value(low, high, x);
}

namespace {

Curve no_curve(std::string why, std::uint32_t line = 0) {
  return {{}, {}, {{{0, line, line > 0 ? 1u : 0u}, std::move(why), ""}}};
}

}  // namespace

Curve curve_of(NumberTable const& table, std::size_t frequency_column, std::size_t value_column) {
  if (!table.problems.empty()) return {{}, {}, table.problems};
  std::size_t const columns = table.column.size();
  if (frequency_column < 1 || value_column < 1 || std::max(frequency_column, value_column) > columns)
    return no_curve(fmt::format("it has {}; columns {} and {} were requested", counted(columns, "column"),
                                frequency_column, value_column));
  Curve curve;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    double const f = table.column[frequency_column - 1][i], v = table.column[value_column - 1][i];
    if (curve.hz.empty() && f == 0) continue;
    if (!(f > 0) || (!curve.hz.empty() && f <= curve.hz.back()))
      return no_curve(fmt::format("the frequency does not increase at {} Hz", f), table.line[i]);
    if (v < 0 || std::isinf(v))
      return no_curve(fmt::format("{} value at {} Hz", v < 0 ? "negative" : "infinite", f), table.line[i]);
    curve.hz.push_back(f);
    curve.value.push_back(v);
  }
  if (curve.hz.size() < 2) return no_curve("fewer than two rows with a frequency above zero");
  return curve;
}

Curve parse_curve(std::string_view text, std::size_t frequency_column, std::size_t value_column) {
  return curve_of(parse_numbers(text), frequency_column, value_column);
}

Curve read_two_columns(Node const& file, std::string const& remedy) {
  auto const table = read_numbers(file, 2, remedy);
  if (!table) return {};
  Curve curve = curve_of(*table);
  for (Problem const& p : curve.problems) file.file_problem(file.text(), p.place.line, p.place.column, p.what, remedy);
  return curve;
}

Curve parse_named_curve(std::string_view text, std::span<std::string_view const> names) {
  NumberTable const table = parse_numbers(text, NonFinite::kept);
  if (!table.problems.empty() || table.column.size() <= 2) return parse_curve(text);
  std::vector<std::string> titles = table.name;
  for (std::string& title : titles) std::replace(title.begin(), title.end(), ' ', '_');
  for (std::string_view const name : names)
    for (std::size_t i = 1; i < titles.size(); ++i)
      if (titles[i] == name) return curve_of(table, 1, i + 1);
  bool const named = std::ranges::any_of(titles, [](std::string const& t) { return !t.empty(); });
  return no_curve(fmt::format("it has {} columns {}, and none is named {}", titles.size(),
                              named ? fmt::format("({})", fmt::join(titles, ", ")) : "without names",
                              fmt::join(names, " or ")));
}

Curve read_named_curve(std::string const& file, std::span<std::string_view const> names, std::string const& remedy) {
  Curve curve = parse_named_curve(read_text(file), names);
  if (curve.problems.empty()) return curve;
  for (Problem& p : curve.problems) p.suggestion = remedy;
  throw errors_in(file, std::move(curve.problems));
}

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
