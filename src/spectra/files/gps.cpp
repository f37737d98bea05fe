// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/files/gps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/math/constants.hpp"
#include "base/text/pattern.hpp"
#include "io/delimited_text.hpp"
#include "io/observatory_data.hpp"

namespace straytrace::spectra {
namespace {

namespace ch = std::chrono;
using ch::sys_days;

constexpr sys_days epoch{ch::year{1980} / 1 / 6};

// Days at whose beginning one more leap second had been added since the GPS epoch (IERS Bulletin C).
constexpr std::array<sys_days, 18> leaps{
    sys_days{ch::year{1981} / 7 / 1}, sys_days{ch::year{1982} / 7 / 1}, sys_days{ch::year{1983} / 7 / 1},
    sys_days{ch::year{1985} / 7 / 1}, sys_days{ch::year{1988} / 1 / 1}, sys_days{ch::year{1990} / 1 / 1},
    sys_days{ch::year{1991} / 1 / 1}, sys_days{ch::year{1992} / 7 / 1}, sys_days{ch::year{1993} / 7 / 1},
    sys_days{ch::year{1994} / 7 / 1}, sys_days{ch::year{1996} / 1 / 1}, sys_days{ch::year{1997} / 7 / 1},
    sys_days{ch::year{1999} / 1 / 1}, sys_days{ch::year{2006} / 1 / 1}, sys_days{ch::year{2009} / 1 / 1},
    sys_days{ch::year{2012} / 7 / 1}, sys_days{ch::year{2015} / 7 / 1}, sys_days{ch::year{2017} / 1 / 1}};

double days_in_seconds(sys_days day) { return 86400.0 * double((day - epoch).count()); }

std::ptrdiff_t leaps_before(sys_days day) { return std::ranges::upper_bound(leaps, day) - leaps.begin(); }

}  // namespace

std::optional<double> gps_of_utc(std::string const& text) {
  static Pattern const form(R"((\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d)(\.\d*)?)?)?Z?)");
  PatternMatch const m = form.match(text);
  if (!m) return {};
  auto const whole = [&](std::size_t i) { return m.matched(i) ? std::stoi(m[i]) : 0; };
  ch::year_month_day const date{ch::year{whole(1)}, ch::month{unsigned(whole(2))}, ch::day{unsigned(whole(3))}};
  if (!date.ok() || whole(4) > 23 || whole(5) > 59 || whole(6) > 60) return {};
  sys_days const day{date};
  bool const leap_day = std::ranges::find(leaps, day + ch::days{1}) != leaps.end();
  if (day < epoch || (whole(6) == 60 && !(leap_day && whole(4) == 23 && whole(5) == 59))) return {};
  double const fraction = m[7].size() > 1 ? std::stod("0" + m[7]) : 0;
  return days_in_seconds(day) + 3600 * whole(4) + 60 * whole(5) + whole(6) + double(leaps_before(day)) + fraction;
}

std::string utc_of_gps(double gps) {
  double second = std::floor(gps), fraction = std::round((gps - second) * 1e6);
  if (fraction >= 1e6) second += 1, fraction = 0;
  // The last day that has begun by then, leap seconds counted.
  sys_days day = epoch + ch::days{std::int64_t(std::floor(second / 86400))};
  while (days_in_seconds(day) + double(leaps_before(day)) > second) day -= ch::days{1};
  auto const rest = int(second - days_in_seconds(day) - double(leaps_before(day)));
  ch::year_month_day const date{day};
  int const hour = std::min(rest / 3600, 23), minute = std::min((rest - 3600 * hour) / 60, 59);
  std::string const part = fraction > 0 ? fmt::format(".{:06.0f}", fraction) : "";
  return fmt::format("{:04d}-{:02d}-{:02d}T{:02d}:{:02d}:{:02d}{}Z", int(date.year()), unsigned(date.month()),
                     unsigned(date.day()), hour, minute, rest - 3600 * hour - 60 * minute, part);
}

std::string gps_text(double gps) {
  std::string text = fmt::format("{:.7f}", gps);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

namespace {

constexpr char const* two_columns = "write two columns: GPS start, GPS end";

std::string shown(std::vector<GpsSpan> const& spans) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(spans.size(), 6); ++i)
    text += fmt::format("{}{}..{}", i > 0 ? ", " : "", gps_text(spans[i].from), gps_text(spans[i].to));
  return spans.size() > 6 ? text + fmt::format(" and {} more", spans.size() - 6) : text;
}

// The column of the starts; a last column of durations and a first one of numbers may surround starts and ends.
std::size_t first_column(NumberTable const& table) { return table.column.size() == 4 ? 1 : 0; }

std::vector<Problem> problems_of(NumberTable const& table) {
  std::vector<Problem> found = table.problems;
  for (Problem& p : found) p.suggestion = two_columns;
  if (!found.empty()) return found;
  if (table.column.size() < 2 || table.column.size() > 4)
    return {{{}, fmt::format("it has {} columns, not start and end", table.column.size()), two_columns}};
  std::size_t const at = first_column(table);
  for (std::size_t i = 0; i < table.rows() && found.size() < 10; ++i) {
    double const from = table.column[at][i], to = table.column[at + 1][i];
    if (!(from < to))
      found.push_back({{0, table.line[i], 1},
                       fmt::format("the segment {}..{} ends before it begins", gps_text(from), gps_text(to)),
                       two_columns});
    else if (at + 2 < table.column.size() && std::abs(table.column[at + 2][i] - (to - from)) > 1e-3)
      found.push_back({{0, table.line[i], 1},
                       fmt::format("the segment {}..{} does not last {:g} s", gps_text(from), gps_text(to),
                                   table.column[at + 2][i]),
                       "columns are start, end; start, end, duration; or number, start, end, duration"});
  }
  return found;
}

std::vector<GpsSpan> joined(std::vector<GpsSpan> spans) {
  std::ranges::sort(spans, {}, &GpsSpan::from);
  std::vector<GpsSpan> out;
  for (GpsSpan const& s : spans)
    if (!out.empty() && s.from <= out.back().to)
      out.back().to = std::max(out.back().to, s.to);
    else
      out.push_back(s);
  return out;
}

bool needs_python(std::string const& file) {
  return std::ranges::any_of(std::array{".xml", ".xml.gz", ".hdf5", ".h5", ".hdf", ".json"},
                             [&](char const* ending) { return file.ends_with(ending); });
}

std::string text_of(std::string const& file, std::string const& flag) {
  if (!needs_python(file)) {
    if (!flag.empty())
      throw InputError(fmt::format("'{}' is columns of text, which hold one flag without a name", file),
                       fmt::format("write {}, or give LIGO_LW, HDF5 or JSON", file));
    return read_text(file);
  }
  ObservatoryData const found = observatory_segments(file, flag);
  if (!found.why.empty()) throw errors_in(file, {{{}, found.why, found.remedy}});
  return found.bytes;
}

}  // namespace

std::vector<GpsSpan> ActiveSegments::within(GpsSpan span) const {
  std::vector<GpsSpan> inside;
  for (GpsSpan const& s : spans)
    if (GpsSpan const both{std::max(s.from, span.from), std::min(s.to, span.to)}; both.from < both.to)
      inside.push_back(both);
  return inside;
}

ActiveSegments parse_segments(std::string const& text, std::string const& file) {
  ActiveSegments found{file, {}};
  if (text_lines(text, Comments::anywhere).empty()) return found;  // never active
  NumberTable const table = parse_numbers(text);
  if (auto problems = problems_of(table); !problems.empty()) throw errors_in(file, std::move(problems));
  std::size_t const at = first_column(table);
  for (std::size_t i = 0; i < table.rows(); ++i) found.spans.push_back({table.column[at][i], table.column[at + 1][i]});
  found.spans = joined(std::move(found.spans));
  return found;
}

ActiveSegments segments_argument(std::string const& argument) {
  std::size_t const mark = argument.find("::");
  std::string const file = argument.substr(0, mark), flag = mark == argument.npos ? "" : argument.substr(mark + 2);
  ActiveSegments found = parse_segments(text_of(file, flag), file);
  found.source = argument;
  return found;
}

GpsSpan only_stretch(ActiveSegments const& active, GpsSpan span) {
  std::vector<GpsSpan> const inside = active.within(span);
  if (inside.size() == 1) return inside[0];
  if (inside.empty())
    throw InputError(fmt::format("'{}' is never active in the requested stretch", active.source),
                     active.spans.empty() ? "choose another flag" : "it is active in GPS " + shown(active.spans));
  throw InputError(fmt::format("'{}' is active in {} stretches, and this needs one without interruption", active.source,
                               inside.size()),
                   fmt::format("choose one with --gps: {}", shown(inside)));
}

void leave_out_inactive(TimeSeries& s, ActiveSegments const& active) {
  std::vector<bool> kept(s.samples.size(), false);
  double const slack = 0.02;  // of a sample
  for (GpsSpan const& span : active.within({s.start, s.end()})) {
    double const from = std::ceil((span.from - s.start) * s.rate - slack),
                 to = std::ceil((span.to - s.start) * s.rate - slack);
    for (std::size_t i = std::size_t(std::max(0.0, from)); double(i) < to && i < kept.size(); ++i) kept[i] = true;
  }
  if (std::ranges::count(kept, true) < 2)
    throw InputError(fmt::format("'{}' is never active in '{}', GPS {}..{}", active.source, s.name, gps_text(s.start),
                                 gps_text(s.end())),
                     active.spans.empty() ? "choose another flag" : "it is active in GPS " + shown(active.spans));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i])
      s.samples[i] = not_a_number;
    else if (!std::isfinite(s.samples[i]))
      throw InputError(fmt::format("'{}' has no valid sample at GPS {}, where '{}' is active", s.name,
                                   gps_text(s.time(i)), active.source),
                       "choose a span without it, or segments that leave it out");
  }
}

}  // namespace straytrace::spectra
