// SPDX-License-Identifier: BSD-3-Clause
// The two kinds of files that hold series. Inside the room; others take signal/series_file.hpp.
#pragma once

#include <string>
#include <vector>

#include "signal/series_file.hpp"

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
