// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/files/series_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/table.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "io/delimited_text.hpp"
#include "io/hdf5/read_write.hpp"
#include "io/observatory_data.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::spectra {
namespace series_source {

void refuse(std::string const& file, std::string const& what, std::string const& suggestion, std::uint32_t line) {
  throw errors_in(file, {{{0, line, 0}, what, suggestion}});
}

namespace {

// Counts, volts and plain numbers need a calibration, which a unit on the command line may supply.
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
    refuse(file, fmt::format("{} is in {} and needs no calibration", place, *in_file),
           "remove the number before the unit: it calibrates only counts, volts and plain numbers");
}

}  // namespace

std::string unit_or_refuse(std::string const& file, std::string const& place, std::string const* found,
                           SeriesRequest const& request) {
  std::string const& wanted = request.unit;
  if (wanted.empty() && !found)
    refuse(file, fmt::format("{} has no unit", place),
           "give --unit, or the option for the unit of this record, for example --unit um/s^2");
  if (found && request.calibrates) refuse_second_calibration(file, place, *found);
  if (found && !wanted.empty() && !request.contradicts) refuse_contradiction(file, place, *found, wanted);
  std::string const text = wanted.empty() ? *found : wanted;
  if (auto const unit = unit_of_file(text)) return *unit;
  std::string const near = likely_unit(text);
  refuse(file, fmt::format("'{}' of {} is not a unit", text, place),
         near.empty() ? "give the unit with --unit, for example --unit m/s^2, V or count"
                      : fmt::format("did you mean '{}'? give it with --unit", near));
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
    throw InputError(fmt::format("cannot read '{}': {}", file, read.why), "name a file, or FILE::CHANNEL");
  return std::move(read.bytes);
}

// HDF5 of the samples of the span.
std::string bytes_of_frames(std::string const& source, SeriesRequest const& wanted) {
  ObservatoryData found = observatory_record({source, wanted.channel, wanted.span.from, wanted.span.to, wanted.gaps});
  if (!found.why.empty()) series_source::refuse(source, found.why, found.remedy);
  std::cerr << found.warnings;
  return std::move(found.bytes);
}

double one_time(std::string const& text, std::string const& all) {
  double value = 0;
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code == std::errc() && end == text.data() + text.size() && std::abs(value) < 1e12) return value;
  if (auto const utc = gps_of_utc(text)) return *utc;
  throw InputError(fmt::format("'{}' in '{}' is neither a GPS time nor UTC", text, all),
                   "write for example 1234567890..1234567950, or 2019-02-01T12:00:00..2019-02-01T12:01:00");
}

struct Calibration {
  double factor = 1;
  std::string unit;
};

// "2e-6 m/s^2": so much is one count, volt or 1 of the file. Units alone, such as "1/m", have no factor.
Calibration calibration_of(std::string const& written) {
  std::string const text = with_plain_spaces(written);
  Calibration c{1, text};
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), c.factor);
  std::string const rest(end, text.data() + text.size());
  std::size_t const unit = rest.find_first_not_of(' ');
  if (code != std::errc() || unit == rest.npos || rest[0] != ' ' || rest[unit] == '/' || rest[unit] == '*')
    return {1, text};
  if (!(std::isfinite(c.factor) && c.factor != 0))
    throw InputError(fmt::format("'{}' calibrates with {:g}", text, c.factor),
                     "write what one count is: \"2e-6 m/s^2\"");
  c.unit = rest.substr(unit);
  return c;
}

std::string without_blanks_around(std::string const& text) {
  auto const first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

}  // namespace

TimeSeries parse_series(std::string const& bytes, std::string const& file, SeriesRequest const& wanted) {
  if (bytes.starts_with("IGWD"))
    series_source::refuse(file, "it is a frame file without the ending .gwf", "give it a name with that ending");
  if (is_hdf5_file(bytes)) return series_source::from_hdf5(bytes, file, wanted);
  refuse_binary(bytes, file);
  return series_source::from_text(bytes, file, wanted);
}

TimeSeries series_argument(std::string const& argument, std::string const& unit, GpsSpan span, bool corrects,
                           Gaps gaps) {
  auto const mark = argument.find("::");
  std::string const file = argument.substr(0, mark);
  auto const [factor, name] = calibration_of(unit);
  SeriesRequest const wanted{mark == argument.npos ? "" : argument.substr(mark + 2),
                             name,
                             span,
                             corrects,
                             name != unit && !corrects,
                             gaps == Gaps::kept};
  TimeSeries s = parse_series(is_observatory_data(file) ? bytes_of_frames(file, wanted) : bytes_of(file), file, wanted);
  if (s.name == file) s.name = std::filesystem::path(file).filename().string();
  if (factor != 1)
    for (double& x : s.samples) x *= factor;
  return s;
}

GpsSpan parse_gps(std::string const& written) {
  std::string const text = with_plain_spaces(written);
  auto const mark = text.find("..");
  std::string const from = without_blanks_around(text.substr(0, mark));
  GpsSpan span;
  if (mark == text.npos) return {one_time(from, text), span.to};
  std::string const to = without_blanks_around(text.substr(mark + 2));
  if (!from.empty()) span.from = one_time(from, text);
  if (!to.empty()) span.to = one_time(to, text);
  if (!(span.from < span.to))
    throw InputError(fmt::format("'{}' ends before it begins", text), "write the earlier time first");
  return span;
}

}  // namespace straytrace::spectra

// Series in columns of text: the first is time in GPS seconds, at regular steps.
namespace straytrace::spectra::series_source {
namespace {

NumberTable read_columns(std::string const& text, std::string const& file) {
  NumberTable table = parse_numbers(text, NonFinite::kept, HeaderRow::allowed);
  for (Problem& p : table.problems) p.suggestion = "a series consists of columns of numbers; the first is time in s";
  if (!table.problems.empty()) throw errors_in(file, std::move(table.problems));
  if (table.column.size() < 2)
    refuse(file, "it has one column; a series also needs the times", "write two columns: time in s, value");
  if (auto const unit = parse_unit(table.unit[0]); !table.unit[0].empty() && !(unit && unit->dimension == dim::time))
    refuse(file, fmt::format("the first column is '{}' in {}, not time", table.name[0], table.unit[0]),
           "a series has time in s in its first column; other commands read spectra");
  if (table.line.size() < 2) refuse(file, "it has one row of numbers", "a series has at least two samples");
  return table;
}

// Names, or numbers from 1 where a column has none; time is not counted.
std::vector<std::string> names_of(NumberTable const& table) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < table.column.size(); ++i)
    names.push_back(table.name[i].empty() ? fmt::format("{}", i) : table.name[i]);
  return names;
}

std::size_t column_of(NumberTable const& table, std::string const& file, std::string const& wanted) {
  std::vector<std::string> const names = names_of(table);
  if (wanted.empty() && names.size() == 1) return 1;
  if (wanted.empty())
    refuse(file, fmt::format("it has {} channels", names.size()),
           fmt::format("name one, for example {}::{}; there are {}", file, names[0], choices(names)));
  auto const hit = std::ranges::find(names, wanted);
  if (hit != names.end()) return 1 + std::size_t(hit - names.begin());
  std::size_t number = 0;
  auto const [end, code] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  if (code == std::errc() && end == wanted.data() + wanted.size() && number >= 1 && number <= names.size())
    return number;
  refuse(file, fmt::format("it has no channel '{}'", wanted),
         did_you_mean(wanted, names, "there are " + choices(names)));
}

// Errors: NaN, times that do not increase, gaps, and steps that vary by more than a quarter of one.
double regular_step(NumberTable const& table, std::vector<double> const& t, std::string const& file) {
  std::vector<double> steps;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i]))
      refuse(file, "the time is not a number", "remove the row, or choose a span without it", table.line[i]);
    if (i > 0) steps.push_back(t[i] - t[i - 1]);
  }
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
  double const usual = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] <= 0)
      refuse(file, fmt::format("the time {} s does not come after {} s", gps_text(t[i + 1]), gps_text(t[i])),
             "times must increase from row to row; write them with enough digits", table.line[i + 1]);
    if (steps[i] > 1.5 * usual)
      refuse(file,
             fmt::format("a gap of {:.6g} s after {} s; the sample step is {:.6g} s", steps[i], gps_text(t[i]), usual),
             fmt::format("choose a span without it, for example --gps {}..{}", gps_text(t[0]), gps_text(t[i])),
             table.line[i + 1]);
    if (std::abs(steps[i] / usual - 1) > 0.25)
      refuse(file,
             fmt::format("the times are not regular: a step of {:.6g} s; the median step is {:.6g} s", steps[i], usual),
             "resample the record at a constant rate, or write the times with more digits", table.line[i + 1]);
  }
  double const mean = (t.back() - t.front()) / double(t.size() - 1);
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::abs(t[i] - t[0] - double(i) * mean) > 0.5 * mean)
      refuse(file, "the clock drifts by more than half a sample", "resample the record at a constant rate",
             table.line[i]);
  if (!(mean >= shortest_step && mean <= longest_step))
    refuse(file, fmt::format("its step is {:g} s", mean), "times are in seconds; state any other unit: time [ms]");
  return mean;
}

// Times are printed with few digits: rounds to a whole rate or a whole step that fits the record equally well.
double meant_rate(double step, std::size_t samples) {
  double const rate = 1 / step, close = 0.1 / double(samples);
  if (double const whole = std::round(rate); whole >= 1 && std::abs(rate / whole - 1) < close) return whole;
  if (double const whole = std::round(step); whole >= 1 && std::abs(step / whole - 1) < close) return 1 / whole;
  return rate;
}

// Rows within the span and one beyond each end, so that cut() can judge; gaps elsewhere do not matter.
NumberTable near_span(NumberTable table, GpsSpan span, double to_seconds) {
  for (double& t : table.column[0]) t *= to_seconds;
  std::vector<double> const& t = table.column[0];
  if (!(span.from < t.back() && span.to > t.front())) return table;  // cut() reports the available times
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
  NumberTable table = read_columns(text, file);
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
    if (!std::isfinite(series.samples[i]) && !wanted.gaps)
      refuse(file, fmt::format("{} is not a number at {} s", place, gps_text(series.time(i))),
             "choose a span without such samples with --gps A..B", table.line[i]);
  return cut(series, wanted.span);
}

}  // namespace straytrace::spectra::series_source

namespace straytrace::spectra {

// Series in HDF5: datasets with their clock in attributes, as gwpy (x0, dx) and GWOSC (Xstart, Xspacing) write them.

namespace {

using namespace series_source;

// A number or a string of one element; anything else, such as a pickled object, counts as absent and is never unpacked.
std::optional<double> number(hdf5::Object const& set, char const* name) {
  auto const found = set.attributes.find(name);
  return found == set.attributes.end() ? std::nullopt : hdf5::number_in(found->second);
}

std::optional<std::string> words(hdf5::Object const& set, char const* name) {
  auto const found = set.attributes.find(name);
  return found == set.attributes.end() ? std::nullopt : hdf5::text_in(found->second);
}

template <class... Names>
std::optional<double> first_number(hdf5::Object const& set, Names... names) {
  std::optional<double> found;
  ((found = found ? found : number(set, names)), ...);
  return found;
}

struct Found {
  std::string path;                   // without the leading slash
  std::string name;                   // of the channel in the file, or the path
  std::string time_unit = "s";        // "Hz" for a spectrum
  std::optional<std::string> unit;    // of the samples
  std::optional<double> start, step;  // s
  std::uint64_t samples = 0;
  bool impossible = false;  // more samples than the file can hold
};

Found described(hdf5::Object const& set, std::string const& path) {
  Found f;
  f.path = f.name = path;
  for (char const* key : {"name", "channel"})
    if (auto const text = words(set, key); text && !text->empty() && *text != "None") f.name = *text;
  f.start = first_number(set, "x0", "t0", "Xstart", "epoch");
  f.step = first_number(set, "dx", "dt", "Xspacing");
  if (auto const rate = number(set, "sample_rate"); rate && !f.step && *rate > 0) f.step = 1 / *rate;
  for (char const* key : {"xunit", "Xunits"})
    if (auto const text = words(set, key)) f.time_unit = *text;
  for (char const* key : {"unit", "Yunits"})
    if (auto const text = words(set, key); text && !f.unit) f.unit = *text;
  f.samples = set.values.count();
  f.impossible = set.values.state == hdf5::State::impossible_size;
  return f;
}

bool is_series(Found const& f) {
  return f.step && (f.time_unit == "s" || f.time_unit == "sec" || f.time_unit.starts_with("second"));
}

// All one-dimensional arrays of numbers, in nested groups too.
void collect(hdf5::Reader const& reader, std::string const& path, std::vector<Found>& into) {
  for (std::string const& name : reader.members("/" + path)) {
    std::string const full = path.empty() ? name : path + "/" + name;
    hdf5::Object const& object = reader.object(full);
    if (object.is_group && object.values.state == hdf5::State::whole) collect(reader, full, into);
    hdf5::Kind const kind = object.values.kind;
    if (!object.is_group && (kind == hdf5::Kind::real || kind == hdf5::Kind::integer) &&
        object.values.shape.size() == 1)
      into.push_back(described(object, full));
  }
}

// GWOSC stores the name of the detector apart from the data.
void name_by_detector(hdf5::Reader const& reader, std::vector<Found>& all) {
  if (!reader.has("meta/Detector")) return;
  auto const detector = hdf5::text_in(reader.object("meta/Detector").values);
  for (Found& f : all)
    if (detector && f.path == "strain/Strain") f.name = *detector + ":strain";
}

template <class Action>
auto readable(std::string const& file, Action const& action) {
  try {
    return action();
  } catch (InputError const& e) {
    refuse(file, e.reason(), "make it again or copy it again");
  }
}

std::vector<Found> series_in(hdf5::Reader const& reader, std::string const& file) {
  std::vector<Found> all, series;
  readable(file, [&] { return collect(reader, "", all); });
  name_by_detector(reader, all);
  bool const gwosc = std::ranges::any_of(all, [](Found const& f) { return f.path == "strain/Strain" && is_series(f); });
  std::copy_if(all.begin(), all.end(), std::back_inserter(series), [&](Found const& f) {
    return is_series(f) && !(gwosc && f.path.starts_with("quality/"));  // bit masks are not records
  });
  if (!series.empty()) return series;
  if (all.empty()) refuse(file, "it contains no list of numbers", "write a series with gwpy, or as columns of text");
  refuse(file, fmt::format("no dataset in it has a sample rate (for example '{}')", all[0].path),
         "series carry the attributes x0 and dx (gwpy) or Xstart and Xspacing (GWOSC); spectra are not series");
}

// Small values such as names are read at once; samples on request.
constexpr std::uint64_t small = 4096;  // bytes

std::vector<std::string> names_of(std::vector<Found> const& all) {
  std::vector<std::string> names;
  for (Found const& f : all) names.push_back(f.path);
  return names;
}

// By path, name of the channel, or by the last part of the path when it is unique.
Found const& chosen(std::vector<Found> const& all, std::string const& file, std::string wanted,
                    hdf5::Reader const& reader) {
  if (wanted.empty() && all.size() == 1) return all[0];
  if (wanted.empty())
    refuse(file, fmt::format("it has {} channels", all.size()),
           fmt::format("name one, for example {}::{}; there are {}", file, all[0].path, choices(names_of(all))));
  if (wanted.starts_with('/')) wanted.erase(0, 1);
  std::vector<Found const*> hits;
  for (Found const& f : all)
    if (f.path == wanted || f.name == wanted) return f;
  for (Found const& f : all)
    if (f.path.ends_with("/" + wanted)) hits.push_back(&f);
  if (hits.size() == 1) return *hits[0];
  if (hits.empty() && reader.has(wanted))
    refuse(file, fmt::format("'{}' has no sample rate", wanted),
           "series carry the attributes x0 and dx (gwpy) or Xstart and Xspacing (GWOSC), in seconds");
  std::string const near = nearest_word(wanted, names_of(all));
  refuse(
      file, fmt::format("it has {} channel '{}'", hits.empty() ? "no" : "more than one", wanted),
      near.empty() || !hits.empty() ? "there are " + choices(names_of(all)) : fmt::format("did you mean '{}'?", near));
}

// Reads the samples of the span, and one more on each side if available; cut() checks the rest.
TimeSeries samples_of(std::string const& image, Found const& f, GpsSpan span) {
  TimeSeries s{f.name, "", *f.start, 1 / *f.step, {}};
  double const whole = std::round(s.rate), count = double(f.samples);
  if (whole >= 1 && std::abs(s.rate / whole - 1) < 1e-12) s.rate = whole;
  double const from = std::clamp(std::floor((span.from - s.start) * s.rate) - 1, 0.0, count);
  double const to = std::clamp(std::ceil((span.to - s.start) * s.rate) + 1, 0.0, count);
  std::uint64_t const offset = to > from ? std::uint64_t(from) : 0;
  s.samples = hdf5::slab(image, f.path, offset, to > from ? std::uint64_t(to) - offset : f.samples);
  s.start += double(offset) / s.rate;
  return s;
}

void check_clock(Found const& f, std::string const& file) {
  if (!f.start)
    refuse(file, fmt::format("'{}' has no start time", f.path), "give it the attribute x0, GPS seconds as a number");
  if (!(*f.step >= shortest_step && *f.step <= longest_step) || !std::isfinite(*f.start))
    refuse(file, fmt::format("'{}' has a step of {:g} s from {:g} s", f.path, *f.step, *f.start),
           "dx is in seconds, between 1e-12 and 1e12");
  if (f.samples < 2) refuse(file, fmt::format("'{}' has fewer than two samples", f.path), "choose another channel");
}

}  // namespace

TimeSeries series_source::from_hdf5(std::string const& bytes, std::string const& file, SeriesRequest const& wanted) {
  hdf5::Reader const reader = readable(file, [&] { return hdf5::Reader(bytes, {.largest = small}); });
  std::vector<Found> const all = series_in(reader, file);
  Found const& f = chosen(all, file, wanted.channel, reader);
  check_clock(f, file);
  if (f.impossible)
    refuse(file, fmt::format("'{}' states {} samples, more than the file can hold", f.path, f.samples),
           "copy or make the file again");
  std::string const place = fmt::format("'{}'", f.path);
  std::string const unit = unit_or_refuse(file, place, f.unit ? &*f.unit : nullptr, wanted);
  double const end = *f.start + double(f.samples) * *f.step;
  bool const inside = (wanted.span.from <= -1e300 || wanted.span.from >= *f.start) &&
                      (wanted.span.to >= 1e300 || wanted.span.to <= end) && wanted.span.from < end;
  GpsSpan const span = inside ? wanted.span : GpsSpan{};  // all, for the message of cut()
  TimeSeries s = readable(file, [&] { return samples_of(bytes, f, span); });
  s.unit = unit;
  s = cut(s, wanted.span);
  for (std::size_t i = 0; i < s.samples.size(); ++i)
    if (!std::isfinite(s.samples[i]) && !wanted.gaps)
      refuse(file, fmt::format("'{}' is not a number at GPS {}", f.path, gps_text(s.time(i))),
             "choose a span without such samples with --gps A..B");
  return s;
}

std::string series_hdf5(std::span<TimeSeries const> series) {
  hdf5::Writer writer;
  std::vector<std::string> taken;
  for (TimeSeries const& s : series) {
    std::string path = s.name.empty() ? "series" : s.name;
    std::replace(path.begin(), path.end(), '/', '_');  // a slash would be a group
    while (std::ranges::find(taken, path) != taken.end()) path += "_";
    taken.push_back(path);
    writer.array(path, s.samples, gwpy_unit(s.unit));
    writer.attribute(path, "name", s.name);
    writer.attribute(path, "channel", s.name);
    writer.attribute(path, "x0", s.start);
    writer.attribute(path, "dx", 1 / s.rate);
    writer.attribute(path, "xunit", std::string("s"));
  }
  return writer.bytes();
}

}  // namespace straytrace::spectra
