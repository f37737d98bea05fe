// SPDX-License-Identifier: BSD-3-Clause
// Time series from and to files: columns of text, CSV, HDF5 of gwpy and GWOSC, frames and NDS2 of the observatories.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/series.hpp"

namespace straytrace::spectra {

// Channel and unit to read from a file. A file with one channel needs no name; the unit must be in the file (HDF5
// attribute, header of the column: "x [um]") or here.
struct SeriesRequest {
  std::string
      channel;       // dataset of HDF5, name or number (from 1, time is not counted) of a column; empty: the only one
  std::string unit;  // overrides that of the file; empty: that of the file
  GpsSpan span;
  bool contradicts = true;  // the unit may contradict the file; false: an error where the file has a calibrated unit
  bool calibrates = false;  // a factor precedes the unit: an error where the file is calibrated
  bool gaps = false;        // samples may be NaN, where they are missing or invalid
};

// From the bytes of a file; the content decides the format. `file`: its name, for messages. Throws InputError with the
// cause, the available channels and the remedy.
TimeSeries parse_series(std::string const& bytes, std::string const& file, SeriesRequest const&);

// The same from an argument of the command line, "FILE" or "FILE::CHANNEL". Reads the file.
// A unit that contradicts a calibrated one of the file (all but counts, volts and 1) is an error unless it `corrects`.
// "2e-6 m/s^2" is a calibration: the value of one count, volt or 1 of the file. Frames and NDS2 may print warnings.
enum class Gaps : bool { refused, kept };  // samples that are NaN
TimeSeries series_argument(std::string const& argument, std::string const& unit, GpsSpan span, bool corrects = false,
                           Gaps = Gaps::refused);

// "1234567890", "1234567890..1234567950", or the same as UTC "2019-02-01T12:00:00"; a single time is the start.
// Throws InputError.
GpsSpan parse_gps(std::string const&);

// Bytes of a file that gwpy opens: one dataset for each series, with x0, dx, xunit, unit, name, channel.
std::string series_hdf5(std::span<TimeSeries const> series);

}  // namespace straytrace::spectra

// Readers of the two kinds of files that hold series, for this folder only.
namespace straytrace::spectra::series_source {

// "witness.txt:LINE: error: problem\n  suggestion" as an InputError; line 0: the file as a whole.
[[noreturn]] void refuse(std::string const& file, std::string const& what, std::string const& suggestion,
                         std::uint32_t line = 0);
// The canonical unit. An error when it is missing or unknown, or when the requested one contradicts a calibrated one of
// the file without permission. `place`: "column 'x'", "dataset 'strain'".
std::string unit_or_refuse(std::string const& file, std::string const& place, std::string const* found,
                           SeriesRequest const& request);
// Available names, for suggestions.
std::string choices(std::vector<std::string> const& names);

TimeSeries from_text(std::string const& text, std::string const& file, SeriesRequest const&);
TimeSeries from_hdf5(std::string const& bytes, std::string const& file, SeriesRequest const&);

}  // namespace straytrace::spectra::series_source
