// SPDX-License-Identifier: BSD-3-Clause
// GPS time and UTC, and files of segments.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/series.hpp"

namespace straytrace::spectra {

// GPS time and UTC: seconds since 1980-01-06 00:00:00 UTC, without leap seconds.

// "2019-02-01T12:00:00", with a space for T, with fractions, with Z; a date alone is its midnight. 23:59:60 only at
// leap seconds. Empty for other texts and before 1980-01-06.
std::optional<double> gps_of_utc(std::string const&);
// "2019-02-01T12:00:00Z", to the microsecond where it is not a whole second. Knows the leap seconds announced until
// 2026.
std::string utc_of_gps(double gps);
// To 0.1 us, without trailing zeros: "1234567890.5".
std::string gps_text(double gps);

// Segments of data quality: stretches of GPS time in which a flag is active.

struct ActiveSegments {
  std::string source;          // FILE or FILE::FLAG
  std::vector<GpsSpan> spans;  // rising, apart from each other

  std::vector<GpsSpan> within(GpsSpan) const;
};

// Columns of text: start, end; start, end, duration; or number, start, end, duration (segwizard). `file`: for messages.
ActiveSegments parse_segments(std::string const& text, std::string const& file);
// The same from an argument, FILE or FILE::FLAG; LIGO_LW (.xml, .xml.gz), HDF5 and JSON by Python.
ActiveSegments segments_argument(std::string const& argument);

// The active stretch within the span. InputError with the stretches where there are several, or none.
GpsSpan only_stretch(ActiveSegments const&, GpsSpan);
// NaN in samples outside; InputError where fewer than two remain.
void leave_out_inactive(TimeSeries&, ActiveSegments const&);

}  // namespace straytrace::spectra
