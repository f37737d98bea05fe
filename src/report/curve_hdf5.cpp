// SPDX-License-Identifier: BSD-3-Clause
// Curves and maps as gwpy reads them: TimeSeries, FrequencySeries and Spectrogram, all with regular axes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "hdf5/writer.hpp"
#include "report/curve_text.hpp"
#include "signal/unit_text.hpp"

namespace straytrace::curve_format {
namespace {

double step_or_refuse(std::vector<double> const& axis, std::string const& name, std::string const& file) {
  if (double const step = regular_step(axis); step > 0) return step;
  std::string const stem = file.substr(0, file.rfind('.'));
  throw InputError(fmt::format(
      "error: '{}': the axis '{}' is not regular, and gwpy files hold regular axes only\n  write it as text: -o {}.txt",
      file, name, stem));
}

std::string free_path(std::string path, std::vector<std::string>& taken) {
  std::replace(path.begin(), path.end(), '/', '_');  // a slash would be a group
  if (path.empty()) path = "curve";
  while (std::find(taken.begin(), taken.end(), path) != taken.end()) path += "_";
  taken.push_back(path);
  return path;
}

void name(hdf5::Writer& writer, std::string const& path, std::string const& of) {
  writer.attribute(path, "name", of);
  writer.attribute(path, "channel", of);
}

void axis(hdf5::Writer& writer, std::string const& path, std::string const& letter, double start, double step,
          std::string const& unit) {
  writer.attribute(path, letter + "0", start);
  writer.attribute(path, "d" + letter, step);
  writer.attribute(path, letter + "unit", gwpy_unit(unit));
}

// On the root: gwpy takes every attribute of a dataset as an argument.
void notes(hdf5::Writer& writer, std::string const& title, std::vector<std::string> const& all) {
  writer.attribute("/", "title", title);
  if (!all.empty()) writer.attribute("/", "notes", fmt::format("{}", fmt::join(all, "\n")));
}

}  // namespace

double regular_step(std::vector<double> const& axis) {
  if (axis.size() < 2) return 0;
  double const step = (axis.back() - axis.front()) / double(axis.size() - 1);
  for (std::size_t i = 0; i < axis.size(); ++i)
    if (!(std::abs(axis[i] - axis[0] - double(i) * step) <= 1e-6 * step + 4e-16 * std::abs(axis[i]))) return 0;
  // GPS times are rounded to 0.2 us: the whole rate is meant where they cannot tell it from ours.
  double const rate = 1 / step, whole = std::round(rate);
  double const rounding = 5e-16 * std::abs(axis.back()) / (axis.back() - axis.front());
  return whole >= 1 && std::abs(rate / whole - 1) <= rounding ? 1 / whole : step;
}

std::string hdf5(CurveSheet const& sheet, std::string const& file) {
  double const step = step_or_refuse(sheet.x.values, sheet.x.name, file);
  straytrace::hdf5::Writer writer;
  std::vector<std::string> taken;
  for (CurveColumn const& c : sheet.y) {
    std::string const path = free_path(c.name, taken);
    writer.array(path, c.values, gwpy_unit(c.unit));
    axis(writer, path, "x", sheet.x.values.front(), step, sheet.x.unit);
    name(writer, path, c.name);
  }
  notes(writer, sheet.title, sheet.notes);
  return writer.bytes();
}

std::string hdf5(MapSheet const& map, std::string const& file) {
  double const step = step_or_refuse(map.time, "time", file), df = step_or_refuse(map.frequency, "frequency", file);
  straytrace::hdf5::Writer writer;
  writer.array("spectrogram", map.value, gwpy_unit(map.unit), {map.time.size(), map.frequency.size()});
  axis(writer, "spectrogram", "x", map.time.front() - step / 2, step,
       "s");  // gwpy counts from the beginning of a stride
  axis(writer, "spectrogram", "y", map.frequency.front(), df, "Hz");
  name(writer, "spectrogram", "spectrogram");
  notes(writer, map.title, map.notes);
  return writer.bytes();
}

}  // namespace straytrace::curve_format
