// SPDX-License-Identifier: BSD-3-Clause
// Time series from and to files: columns of text, CSV, HDF5 as gwpy and GWOSC write it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "spectra/series.hpp"

namespace straytrace {

// What is wanted of a file. A file with one channel needs no name; the unit must be in the file (HDF5 attribute, header
// of the column: "x [um]") or here.
struct SeriesRequest {
  std::string
      channel;       // dataset of HDF5, name or number (from 1, time is not counted) of a column; empty: the only one
  std::string unit;  // overrides the one of the file; empty: that of the file
  GpsSpan span;
  bool contradicts = true;  // the unit may; false: refused where the file has a calibrated one
  bool calibrates = false;  // a factor before the unit is applied afterwards: refused where the file is calibrated
};

// From the bytes of a file; `file`: its name, for messages and by its ending for nothing: the content decides what it
// is. Throws InputError that names what is missing, what there is, and what to write.
TimeSeries parse_series(std::string const& bytes, std::string const& file, SeriesRequest const&);

// The same from an argument of the command line, "FILE" or "FILE::CHANNEL". Reads the file.
// A unit that contradicts a calibrated one of the file (all but counts, volts and 1) is refused, unless it `corrects`.
// "2e-6 m/s^2" is a calibration: one count, volt or 1 of the file is so much.
TimeSeries series_argument(std::string const& argument, std::string const& unit, GpsSpan span, bool corrects = false);

// "1234567890", "1234567890..1234567950", or the same as UTC "2019-02-01T12:00:00"; a single time is the beginning.
// Throws InputError.
GpsSpan parse_gps(std::string const&);

// Bytes of a file that gwpy opens: one dataset for each series, with x0, dx, xunit, unit, name, channel.
std::string series_hdf5(std::span<TimeSeries const> series);

}  // namespace straytrace

// The two kinds of files that hold series. Inside the room; others take spectra/files/series_file.hpp.
namespace straytrace::series_source {

// "witness.txt: what\n  suggestion" as an InputError.
[[noreturn]] void refuse(std::string const& file, std::string const& what, std::string const& suggestion);
// The canonical unit; refuses one that is missing or not understood, and, where the request does not allow it, a
// wanted one that contradicts a calibrated one of the file. `place`: "column 'x'", "dataset 'strain'".
std::string unit_or_refuse(std::string const& file, std::string const& place, std::string const* found,
                           SeriesRequest const& request);
// Names that are there, as a suggestion.
std::string choices(std::vector<std::string> const& names);

TimeSeries from_text(std::string const& text, std::string const& file, SeriesRequest const&);
TimeSeries from_hdf5(std::string const& bytes, std::string const& file, SeriesRequest const&);

}  // namespace straytrace::series_source
