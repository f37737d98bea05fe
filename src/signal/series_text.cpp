// SPDX-License-Identifier: BSD-3-Clause
// Series in columns of text: the first is time in GPS seconds, at regular steps.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/quantity.hpp"
#include "base/table.hpp"
#include "signal/gps.hpp"
#include "signal/series_sources.hpp"
#include "signal/text_table.hpp"

namespace straytrace::series_source {
namespace {

NamedColumns read_columns(std::string const& text, std::string const& file) {
  NamedColumns table = parse_named_columns(text);
  if (!table.error.empty()) refuse(file, table.error, "series are columns of numbers, the first of them time in s");
  if (table.column.size() < 2)
    refuse(file, "it has one column, and a series needs the times too", "write two columns: time in s, value");
  if (auto const unit = parse_unit(table.unit[0]); !table.unit[0].empty() && !(unit && unit->dimension == dim::time))
    refuse(file, fmt::format("the first column is '{}' in {}, not time", table.name[0], table.unit[0]),
           "a series has time in s in its first column; a spectrum is read by other commands");
  if (table.line.size() < 2) refuse(file, "it has one row of numbers", "a series has at least two samples");
  return table;
}

// Names, or numbers from 1 where a column has none; time is not counted.
std::vector<std::string> names_of(NamedColumns const& table) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < table.column.size(); ++i)
    names.push_back(table.name[i].empty() ? fmt::format("{}", i) : table.name[i]);
  return names;
}

std::size_t column_of(NamedColumns const& table, std::string const& file, std::string const& wanted) {
  std::vector<std::string> const names = names_of(table);
  if (wanted.empty() && names.size() == 1) return 1;
  if (wanted.empty())
    refuse(file, fmt::format("it has {} channels", names.size()),
           fmt::format("name one, for example {}::{}; there are {}", file, names[0], choices(names)));
  auto const hit = std::find(names.begin(), names.end(), wanted);
  if (hit != names.end()) return 1 + std::size_t(hit - names.begin());
  std::size_t number = 0;
  auto const [end, code] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  if (code == std::errc() && end == wanted.data() + wanted.size() && number >= 1 && number <= names.size())
    return number;
  std::string const near = nearest_word(wanted, names);
  refuse(file, fmt::format("it has no channel '{}'", wanted),
         near.empty() ? "there are " + choices(names) : fmt::format("did you mean '{}'?", near));
}

std::string at_line(NamedColumns const& table, std::size_t row) { return fmt::format("line {}: ", table.line[row]); }

// Refuses NaN, times that stand still or run back, gaps, and steps that vary by more than a quarter of one.
double regular_step(NamedColumns const& table, std::vector<double> const& t, std::string const& file) {
  std::vector<double> steps;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i]))
      refuse(file, at_line(table, i) + "the time is not a number", "remove the row, or choose a span without it");
    if (i > 0) steps.push_back(t[i] - t[i - 1]);
  }
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
  double const usual = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] <= 0)
      refuse(file,
             fmt::format("{}the time {} s does not come after {} s", at_line(table, i + 1), gps_text(t[i + 1]),
                         gps_text(t[i])),
             "times rise from row to row, written with enough digits");
    if (steps[i] > 1.5 * usual)
      refuse(file,
             fmt::format("{}a gap of {:.6g} s after {} s, where samples stand {:.6g} s apart", at_line(table, i + 1),
                         steps[i], gps_text(t[i]), usual),
             fmt::format("choose a span without it, for example --gps {}..{}", gps_text(t[0]), gps_text(t[i])));
    if (std::abs(steps[i] / usual - 1) > 0.25)
      refuse(file,
             fmt::format("{}the times are not regular: {:.6g} s after steps of {:.6g} s", at_line(table, i + 1),
                         steps[i], usual),
             "resample the record at a constant rate, or write the times with more digits");
  }
  double const mean = (t.back() - t.front()) / double(t.size() - 1);
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::abs(t[i] - t[0] - double(i) * mean) > 0.5 * mean)
      refuse(file, at_line(table, i) + "the clock drifts by more than half a sample",
             "resample the record at a constant rate");
  if (!(mean >= shortest_step && mean <= longest_step))
    refuse(file, fmt::format("its step is {:g} s", mean), "times are in seconds, or say their unit: time [ms]");
  return mean;
}

// Times are printed with few digits: the whole rate or whole step is meant where the record cannot tell it from ours.
double meant_rate(double step, std::size_t samples) {
  double const rate = 1 / step, close = 0.1 / double(samples);
  if (double const whole = std::round(rate); whole >= 1 && std::abs(rate / whole - 1) < close) return whole;
  if (double const whole = std::round(step); whole >= 1 && std::abs(step / whole - 1) < close) return 1 / whole;
  return rate;
}

// Rows within the span and one beyond each end, so that cut() can judge; gaps elsewhere do not matter.
NamedColumns near_span(NamedColumns table, GpsSpan span, double to_seconds) {
  for (double& t : table.column[0]) t *= to_seconds;
  std::vector<double> const& t = table.column[0];
  if (!(span.from < t.back() && span.to > t.front())) return table;  // cut() says what there is
  std::size_t first = 0, last = t.size();
  while (first + 1 < t.size() && t[first + 1] <= span.from) ++first;
  while (last > first + 2 && t[last - 2] >= span.to) --last;
  auto const keep = [&](auto& v) {
    v.erase(v.begin() + std::ptrdiff_t(last), v.end());
    v.erase(v.begin(), v.begin() + std::ptrdiff_t(first));
  };
  for (auto& c : table.column) keep(c);
  keep(table.line);
  return table;
}

}  // namespace

TimeSeries from_text(std::string const& text, std::string const& file, SeriesRequest const& wanted) {
  NamedColumns table = read_columns(text, file);
  std::size_t const channel = column_of(table, file, wanted.channel);
  std::string const place = table.name[channel].empty() ? fmt::format("column {}", channel + 1)
                                                        : fmt::format("column '{}'", table.name[channel]);
  std::string const& written = table.unit[channel];
  std::string const unit = unit_or_refuse(file, place, written.empty() ? nullptr : &written, wanted);
  double const to_seconds = table.unit[0].empty() ? 1 : parse_unit(table.unit[0])->si;
  table = near_span(std::move(table), wanted.span, to_seconds);
  double const step = regular_step(table, table.column[0], file);
  TimeSeries series{table.name[channel].empty() ? file : table.name[channel], unit, table.column[0].front(),
                    meant_rate(step, table.line.size()), std::move(table.column[channel])};
  for (std::size_t i = 0; i < series.samples.size(); ++i)
    if (!std::isfinite(series.samples[i]))
      refuse(file, fmt::format("{}{} is not a number at {} s", at_line(table, i), place, gps_text(series.time(i))),
             "choose a span without such samples with --gps A..B");
  return cut(series, wanted.span);
}

}  // namespace straytrace::series_source
