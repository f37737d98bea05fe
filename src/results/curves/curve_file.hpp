// SPDX-License-Identifier: BSD-3-Clause
// Curves of the commands for recorded data, in the format given by the name of the file.
#pragma once

#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::results {

struct CurveColumn {
  std::string name, unit;  // "h_mean", "1/sqrt(Hz)"
  std::vector<double> values;
  std::string style = "line";  // in pictures: line, band-low, band-high, points, upper-limit, hidden
};

struct CurveSheet {
  std::string title;               // one line
  std::vector<std::string> notes;  // settings and sources, one line each: window, segment, averages, files
  CurveColumn x;                   // Hz or GPS s
  bool log_x = true, log_y = true;
  std::vector<CurveColumn> y;  // all as long as x
};

// A map over time and frequency.
struct MapSheet {
  std::string title, unit;
  std::vector<std::string> notes;
  std::vector<double> time, frequency;  // GPS s and Hz, centres
  std::vector<double> value;            // value[time * frequencies + frequency]
  std::vector<CurveColumn> lines;       // drawn over it: values in Hz, one for each element of line_time
  std::vector<double> line_time;        // GPS s
};

// By the ending: .txt and .csv (comment header with title, notes, units, version), .hdf5 or .h5 (gwpy; regular axes
// only, otherwise an InputError names the text file), .png, .html (one self-contained page with picture and table),
// .json. All files or none. Throws InputError for another ending or a failing disk.
void write_curves(std::vector<std::string> const& files, CurveSheet const&);
void write_map(std::vector<std::string> const& files, MapSheet const&);
// Content of the .json files, for standard output.
std::string curve_json(CurveSheet const&);
std::string curve_json(MapSheet const&);
// Before anything is computed: throws InputError when the file has none of the `known` endings. `option`: in front.
void check_ending(std::string const& file, std::vector<std::string> const& known, std::string const& option);
// Before anything is computed: throws InputError when write_curves has no format for the ending. `option`: in front.
void check_curve_ending(std::string const& file, std::string const& option = "");

}  // namespace straytrace::results

// The same formats as bytes, for this module.
namespace straytrace::results::curve_format {

std::string text(CurveSheet const&);
std::string csv(CurveSheet const&);
std::string json(CurveSheet const&);
std::string hdf5(CurveSheet const&, std::string const& file);  // InputError for an irregular axis
std::string text(MapSheet const&);
std::string csv(MapSheet const&);
std::string json(MapSheet const&);
std::string hdf5(MapSheet const&, std::string const& file);
// One page: title, notes, picture inline, table.
std::string html(CurveSheet const&, std::string const& png);
std::string html(MapSheet const&, std::string const& png);

// The step of an axis, or 0 where it is not regular to 1e-6 of a step.
double regular_step(std::vector<double> const& axis);

}  // namespace straytrace::results::curve_format
