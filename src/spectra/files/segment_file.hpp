// SPDX-License-Identifier: BSD-3-Clause
// Segments of data quality: stretches of GPS time in which a flag is active.
#pragma once

#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/series.hpp"

namespace straytrace::spectra {

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
