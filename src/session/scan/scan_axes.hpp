// SPDX-License-Identifier: BSD-3-Clause
// "aperture=50cm..80cm:7" and "n=40,80,160": the values that a scan gives to parameters.
#pragma once

#include <string>
#include <vector>

#include "base/errors.hpp"

namespace straytrace::session {

struct ScanAxis {
  std::string name;
  std::vector<std::string> values;  // as -p takes them: "0.55 m", "80"
  std::vector<double> numbers;      // for pictures, in the unit written; NaN where a value is not a number
  std::string unit;                 // of the numbers; empty: plain
  bool range = false;               // given as lo..hi, with or without a count
};

// Throws one InputError with all problems. `open`: a range may omit the count, as for --invert.
std::vector<ScanAxis> parse_axes(std::vector<std::string> const& words, bool open);

// "name=value" of each parameter, for every combination; the last parameter changes first.
std::vector<std::vector<std::string>> combinations(std::vector<ScanAxis> const&);

// A CSV of points: a header of parameters with their units, "rim [cm], baffles", and a row for each point. Throws one
// InputError with all problems.
struct ScanList {
  std::vector<ScanAxis> axes;  // columns
  std::vector<std::vector<std::string>> points;
  std::string file = {};
  std::vector<std::vector<Place>> places = {};  // of the values in the file
};
ScanList read_points(std::string const& file);
// The error of a point with the places in the file of points instead of those in the command line, in which the
// settings of the point come after `overrides` others.
InputError in_points(InputError const&, ScanList const&, std::size_t point, std::size_t overrides);

}  // namespace straytrace::session
