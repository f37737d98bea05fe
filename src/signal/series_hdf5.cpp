// SPDX-License-Identifier: BSD-3-Clause
// Series in HDF5: datasets with their clock in attributes, as gwpy (x0, dx) and GWOSC (Xstart, Xspacing) write them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/message.hpp"
#include "base/table.hpp"
#include "hdf5/hdf5.hpp"
#include "signal/gps.hpp"
#include "signal/series_sources.hpp"
#include "signal/unit_text.hpp"

namespace straytrace {
namespace {

using namespace series_source;

// A number or a string of one element; anything else, such as a pickled object, counts as absent and is never unpacked.
std::optional<double> number(H5::DataSet const& set, char const* name) {
  if (!set.attrExists(name)) return {};
  H5::Attribute const a = set.openAttribute(name);
  H5T_class_t const kind = a.getTypeClass();
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || a.getSpace().getSimpleExtentNpoints() != 1) return {};
  double value = 0;
  a.read(H5::PredType::NATIVE_DOUBLE, &value);
  return value;
}

std::optional<std::string> words(H5::DataSet const& set, char const* name) {
  if (!set.attrExists(name)) return {};
  H5::Attribute const a = set.openAttribute(name);
  if (a.getTypeClass() != H5T_STRING || a.getSpace().getSimpleExtentNpoints() != 1) return {};
  std::string value;
  a.read(a.getDataType(), value);
  value.erase(std::find(value.begin(), value.end(), '\0'), value.end());
  return value;
}

template <class... Names>
std::optional<double> first_number(H5::DataSet const& set, Names... names) {
  std::optional<double> found;
  ((found = found ? found : number(set, names)), ...);
  return found;
}

struct Found {
  std::string path;                   // without the leading slash
  std::string name;                   // of the channel as the file says it, or the path
  std::string time_unit = "s";        // "Hz" for a spectrum
  std::optional<std::string> unit;    // of the samples
  std::optional<double> start, step;  // s
  hsize_t samples = 0;
};

Found described(H5::DataSet const& set, std::string const& path) {
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
  f.samples = hsize_t(set.getSpace().getSimpleExtentNpoints());
  return f;
}

bool is_series(Found const& f) {
  return f.step && (f.time_unit == "s" || f.time_unit == "sec" || f.time_unit.starts_with("second"));
}

// All one-dimensional arrays of numbers, in nested groups too.
void collect(H5::Group const& group, std::string const& path, int depth, std::vector<Found>& into) {
  for (hsize_t i = 0; depth < 16 && i < group.getNumObjs(); ++i) {
    std::string const name = group.getObjnameByIdx(i), full = path.empty() ? name : path + "/" + name;
    if (group.getObjTypeByIdx(i) == H5G_GROUP) collect(group.openGroup(name), full, depth + 1, into);
    if (group.getObjTypeByIdx(i) != H5G_DATASET) continue;
    H5::DataSet const set = group.openDataSet(name);
    H5T_class_t const kind = set.getTypeClass();
    if ((kind == H5T_FLOAT || kind == H5T_INTEGER) && set.getSpace().getSimpleExtentNdims() == 1)
      into.push_back(described(set, full));
  }
}

// GWOSC names the detector beside the data, not at them.
void name_by_detector(hdf5::Reader const& reader, std::vector<Found>& all) {
  if (!reader.has("meta") || !reader.has("meta/Detector")) return;
  H5::DataSet const set = reader.file().openDataSet("meta/Detector");
  std::string detector;
  if (set.getTypeClass() != H5T_STRING) return;
  set.read(detector, set.getDataType());
  detector.erase(std::find(detector.begin(), detector.end(), '\0'), detector.end());
  for (Found& f : all)
    if (f.path == "strain/Strain") f.name = detector + ":strain";
}

template <class Action>
auto readable(std::string const& file, Action const& action) {
  try {
    return action();
  } catch (H5::Exception const&) {
    refuse(file, "the HDF5 file is damaged", "make it again or copy it again");
  }
}

std::vector<Found> series_in(hdf5::Reader const& reader, std::string const& file) {
  std::vector<Found> all, series;
  collect(reader.file().openGroup("/"), "", 0, all);
  name_by_detector(reader, all);
  bool const gwosc =
      std::any_of(all.begin(), all.end(), [](Found const& f) { return f.path == "strain/Strain" && is_series(f); });
  std::copy_if(all.begin(), all.end(), std::back_inserter(series), [&](Found const& f) {
    return is_series(f) && !(gwosc && f.path.starts_with("quality/"));  // masks of bits are no records
  });
  if (!series.empty()) return series;
  if (all.empty()) refuse(file, "it holds no list of numbers", "write a series with gwpy, or as columns of text");
  refuse(file, fmt::format("no dataset in it has a sample rate ('{}' has not)", all[0].path),
         "series carry the attributes x0 and dx (gwpy) or Xstart and Xspacing (GWOSC); spectra are no series");
}

hdf5::Reader opened(std::string const& bytes, std::string const& file) {
  try {
    return hdf5::Reader(bytes);
  } catch (InputError const&) {
    refuse(file, "the HDF5 file is damaged", "make it again or copy it again");
  }
}

std::vector<std::string> names_of(std::vector<Found> const& all) {
  std::vector<std::string> names;
  for (Found const& f : all) names.push_back(f.path);
  return names;
}

// By path, name of the channel, or the last part of the path where only one has it.
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

// Reads the samples of the span, and one more on each side where there is one; cut() judges the rest.
TimeSeries samples_of(hdf5::Reader const& reader, Found const& f, GpsSpan span) {
  TimeSeries s{f.name, "", *f.start, 1 / *f.step, {}};
  double const whole = std::round(s.rate), count = double(f.samples);
  if (whole >= 1 && std::abs(s.rate / whole - 1) < 1e-12) s.rate = whole;
  double const from = std::clamp(std::floor((span.from - s.start) * s.rate) - 1, 0.0, count);
  double const to = std::clamp(std::ceil((span.to - s.start) * s.rate) + 1, 0.0, count);
  hsize_t const offset = to > from ? hsize_t(from) : 0, wanted = to > from ? hsize_t(to) - offset : f.samples;
  s.samples.resize(wanted);
  H5::DataSet const set = reader.file().openDataSet(f.path);
  H5::DataSpace in_file = set.getSpace(), in_memory(1, &wanted);
  in_file.selectHyperslab(H5S_SELECT_SET, &wanted, &offset);
  set.read(s.samples.data(), H5::PredType::NATIVE_DOUBLE, in_memory, in_file);
  s.start += double(offset) / s.rate;
  return s;
}

void check_clock(Found const& f, std::string const& file) {
  if (!f.start)
    refuse(file, fmt::format("'{}' does not say when it begins", f.path),
           "give it the attribute x0, GPS seconds as a number");
  if (!(*f.step >= shortest_step && *f.step <= longest_step) || !std::isfinite(*f.start))
    refuse(file, fmt::format("'{}' has a step of {:g} s from {:g} s", f.path, *f.step, *f.start),
           "dx is in seconds, between 1e-12 and 1e12");
  if (f.samples < 2) refuse(file, fmt::format("'{}' has fewer than two samples", f.path), "choose another channel");
}

}  // namespace

TimeSeries series_source::from_hdf5(std::string const& bytes, std::string const& file, SeriesRequest const& wanted) {
  hdf5::Reader const reader = opened(bytes, file);
  return readable(file, [&] {
    std::vector<Found> const all = series_in(reader, file);
    Found const& f = chosen(all, file, wanted.channel, reader);
    check_clock(f, file);
    if (!reader.can_hold(f.samples))  // a byte each at least
      refuse(file, fmt::format("'{}' states {} samples, more than the file can hold", f.path, f.samples),
             "copy or make the file again");
    std::string const place = fmt::format("'{}'", f.path);
    std::string const unit = unit_or_refuse(file, place, f.unit ? &*f.unit : nullptr, wanted);
    double const end = *f.start + double(f.samples) * *f.step;
    bool const inside = (wanted.span.from <= -1e300 || wanted.span.from >= *f.start) &&
                        (wanted.span.to >= 1e300 || wanted.span.to <= end) && wanted.span.from < end;
    TimeSeries s = samples_of(reader, f, inside ? wanted.span : GpsSpan{});  // all, for what cut() says about it
    s.unit = unit;
    s = cut(s, wanted.span);
    for (std::size_t i = 0; i < s.samples.size(); ++i)
      if (!std::isfinite(s.samples[i]))
        refuse(file, fmt::format("'{}' is not a number at GPS {}", f.path, gps_text(s.time(i))),
               "choose a span without such samples with --gps A..B");
    return s;
  });
}

std::string series_hdf5(std::span<TimeSeries const> series) {
  hdf5::Writer writer;
  std::vector<std::string> taken;
  for (TimeSeries const& s : series) {
    std::string path = s.name.empty() ? "series" : s.name;
    std::replace(path.begin(), path.end(), '/', '_');  // a slash would be a group
    while (std::find(taken.begin(), taken.end(), path) != taken.end()) path += "_";
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

}  // namespace straytrace
