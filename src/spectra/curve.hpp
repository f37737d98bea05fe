// SPDX-License-Identifier: BSD-3-Clause
// Sampled functions of frequency and their interpolation: straight lines in log-log, that is power laws between
// samples.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/input/table.hpp"

namespace straytrace::io {
struct NumberTable;  // io/delimited_text.hpp
}  // namespace straytrace::io

namespace straytrace::spectra {

// Position of `hz` between two frequencies on a logarithmic axis: 0 at `low`, 1 at `high`.
inline double log_share(double hz, double low, double high) { return std::log(hz / low) / std::log(high / low); }
// Value at this position on the straight line in log-log between two values above zero.
inline double log_log_value(double low, double high, double share) { return low * std::pow(high / low, share); }
// Value at `f` of samples at increasing frequencies; next to a sample of 0 linear over log f. NaN outside the range and
// where a neighbour is NaN.
double log_log_at(std::span<double const> hz, std::span<double const> value, double f);

// Two columns of a table. `hz` increases; a first row at 0 Hz is dropped.
struct Curve {
  std::vector<double> hz, value;
  std::vector<Problem> problems;  // why there is no curve, at lines of the text, without remedies
  double at(double f) const { return log_log_at(hz, value, f); }
};
// Columns are counted from 1.
Curve curve_of(NumberTable const&, std::size_t frequency_column = 1, std::size_t value_column = 2);
Curve parse_curve(std::string_view text, std::size_t frequency_column = 1, std::size_t value_column = 2);

// A file that a scene names, of two columns and no more. Empty, with problems of the scene, where it is not.
Curve read_two_columns(Node const& file, std::string const& remedy);

// Columns of our own text files that hold an ASD of strain: of budget.txt and of h_asd.txt.
constexpr std::string_view strain_columns[] = {"total_strain", "h_mean"};
// Two columns; of more, the one with the first of these names in a comment above the numbers (blanks as underscores),
// where NaN means "not known". An error that lists the columns when there is no such name.
Curve parse_named_curve(std::string_view text, std::span<std::string_view const> names);
// The same of a file; throws InputError at its lines.
Curve read_named_curve(std::string const& file, std::span<std::string_view const> names, std::string const& remedy);

}  // namespace straytrace::spectra
