// SPDX-License-Identifier: BSD-3-Clause
#include "signal/series_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "base/file_bytes.hpp"
#include "base/message.hpp"
#include "base/quantity.hpp"
#include "signal/gps.hpp"
#include "signal/series_sources.hpp"
#include "signal/unit_text.hpp"

namespace straytrace {
namespace series_source {

void refuse(std::string const& file, std::string const& what, std::string const& suggestion) {
  Problem const problem{{1, 0, 0}, what, suggestion, Severity::error, 1};
  throw InputError({problem}, fmt::format("{}: error: {}\n  {}", file, what, suggestion), {"", file});
}

namespace {

// Counts, volts and plain numbers await a calibration, which a unit on the command line may be.
bool is_calibrated(Quantity const& unit) {
  return unit.dimension.count == 0 && unit.dimension.volt == 0 && !(unit.dimension == dim::plain);
}

void refuse_contradiction(std::string const& file, std::string const& place, std::string const& found,
                          std::string const& wanted) {
  auto const in_file = unit_of_file(found), said = unit_of_file(wanted);
  if (!in_file || !said) return;
  auto const a = parse_unit(*in_file), b = parse_unit(*said);
  if (is_calibrated(*a) && !(a->dimension == b->dimension && a->si == b->si))
    refuse(file, fmt::format("{} is in {}, not in {}", place, *in_file, *said),
           "leave the unit to the file, or correct it: straytrace signal convert --unit");
}

void refuse_second_calibration(std::string const& file, std::string const& place, std::string const& found) {
  auto const in_file = unit_of_file(found);
  auto const unit = in_file ? parse_unit(*in_file) : std::nullopt;
  if (unit && is_calibrated(*unit))
    refuse(file, fmt::format("{} is in {}, which needs no calibration", place, *in_file),
           "a number before the unit is for counts, volts and plain numbers: leave it out");
}

}  // namespace

std::string unit_or_refuse(std::string const& file, std::string const& place, std::string const* found,
                           SeriesRequest const& request) {
  std::string const& wanted = request.unit;
  if (wanted.empty() && !found)
    refuse(file, fmt::format("{} has no unit", place),
           "say it with --unit, or the option that names the unit of this record, for example --unit um/s^2");
  if (found && request.calibrates) refuse_second_calibration(file, place, *found);
  if (found && !wanted.empty() && !request.contradicts) refuse_contradiction(file, place, *found, wanted);
  std::string const text = wanted.empty() ? *found : wanted;
  if (auto const unit = unit_of_file(text)) return *unit;
  std::string const near = likely_unit(text);
  refuse(file, fmt::format("'{}' of {} is not a unit", text, place),
         near.empty() ? "say the unit with --unit, for example --unit m/s^2, V or count"
                      : fmt::format("did you mean '{}'? say it with --unit", near));
}

std::string choices(std::vector<std::string> const& names) {
  std::size_t const most = 12;
  std::vector<std::string> const shown(names.begin(), names.begin() + std::ptrdiff_t(std::min(names.size(), most)));
  return fmt::format("{}{}", fmt::join(shown, ", "),
                     names.size() > most ? fmt::format(" and {} more", names.size() - most) : "");
}

}  // namespace series_source

namespace {

bool is_hdf5_file(std::string const& bytes) { return bytes.starts_with("\x89HDF\r\n\x1a\n"); }

std::string bytes_of(std::string const& file) {
  FileBytes read = bytes_of_file(file);
  if (!read.why.empty())
    throw InputError(fmt::format("error: cannot read '{}': {}\n  name a file, or FILE::CHANNEL", file, read.why));
  return std::move(read.bytes);
}

double one_time(std::string const& text, std::string const& all) {
  double value = 0;
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code == std::errc() && end == text.data() + text.size() && std::abs(value) < 1e12) return value;
  if (auto const utc = gps_of_utc(text)) return *utc;
  throw InputError(
      fmt::format("error: '{}' in '{}' is neither a GPS time nor UTC\n  write for example 1234567890..1234567950, or "
                  "2019-02-01T12:00:00..2019-02-01T12:01:00",
                  text, all));
}

struct Calibration {
  double factor = 1;
  std::string unit;
};

// "2e-6 m/s^2": so much is one count, volt or 1 of the file. Units alone, such as "1/m", have no factor.
Calibration calibration_of(std::string const& text) {
  Calibration c{1, text};
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), c.factor);
  std::string const rest(end, text.data() + text.size());
  std::size_t const unit = rest.find_first_not_of(' ');
  if (code != std::errc() || unit == rest.npos || rest[0] != ' ' || rest[unit] == '/' || rest[unit] == '*')
    return {1, text};
  if (!(std::isfinite(c.factor) && c.factor != 0))
    throw InputError(
        fmt::format("error: '{}' calibrates with {:g}\n  write what one count is: \"2e-6 m/s^2\"", text, c.factor));
  c.unit = rest.substr(unit);
  return c;
}

std::string without_blanks_around(std::string const& text) {
  auto const first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

}  // namespace

TimeSeries parse_series(std::string const& bytes, std::string const& file, SeriesRequest const& wanted) {
  if (is_hdf5_file(bytes)) return series_source::from_hdf5(bytes, file, wanted);
  return series_source::from_text(bytes, file, wanted);
}

TimeSeries series_argument(std::string const& argument, std::string const& unit, GpsSpan span, bool corrects) {
  auto const mark = argument.find("::");
  std::string const file = argument.substr(0, mark);
  auto const [factor, name] = calibration_of(unit);
  SeriesRequest const wanted{mark == argument.npos ? "" : argument.substr(mark + 2), name, span, corrects,
                             name != unit && !corrects};
  TimeSeries s = parse_series(bytes_of(file), std::filesystem::path(file).filename().string(), wanted);
  if (factor != 1)
    for (double& x : s.samples) x *= factor;
  return s;
}

GpsSpan parse_gps(std::string const& text) {
  auto const mark = text.find("..");
  std::string const from = without_blanks_around(text.substr(0, mark));
  GpsSpan span;
  if (mark == text.npos) return {one_time(from, text), span.to};
  std::string const to = without_blanks_around(text.substr(mark + 2));
  if (!from.empty()) span.from = one_time(from, text);
  if (!to.empty()) span.to = one_time(to, text);
  if (!(span.from < span.to))
    throw InputError(fmt::format("error: '{}' ends before it begins\n  write the earlier time first", text));
  return span;
}

}  // namespace straytrace
