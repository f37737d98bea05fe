// SPDX-License-Identifier: BSD-3-Clause
// Series in HDF5: datasets with their clock in attributes, as gwpy (x0, dx) and GWOSC (Xstart, Xspacing) write them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "io/hdf5/reader.hpp"
#include "io/hdf5/writer.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::spectra {
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
