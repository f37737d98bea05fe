// SPDX-License-Identifier: BSD-3-Clause
// Sampled functions of frequency and their interpolation: straight lines in log-log, that is power laws between
// samples.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "base/units/quantity.hpp"
#include "spectra/series.hpp"

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

// Accelerometers and velocity meters to displacement (docs/theory/motion.md, eq. 11.3; R6.05).

// Number of integrations, up to 2, from a unit to a dimension; empty: none of them leads there.
std::optional<int> integrations_to(Dimension, std::string const& unit);
// Number of integrations to metres: 2 from m/s^2, 1 from m/s, 0 from m. Throws InputError with a remedy for other
// units.
int integrations_to_displacement(std::string const& unit);

// One-sided ASD divided by (2 pi f)^times (eq. 11.3); f > 0.
double integrated_asd(double asd, double hz, int times);

// The record integrated `times` times, in SI units. Throws InputError when the unit contains no time to integrate.
// In the frequency domain: lines divided by (2 pi i f)^times behind the high pass (f/c)^4/(1 + (f/c)^4), c = corner_hz,
// both without phase error: 1 % too small at 3.2 c, right above. The mean is removed. Odd reflection continues the
// record beyond its ends, and the result is uncertain within about 1/c of them.
TimeSeries integrated(TimeSeries const&, int times, double corner_hz);
// An integrated record without its ends: integration lacks the motion before and after it. The error after the high
// pass falls as exp(-sqrt(2) pi corner t), to 1.4e-4 in the two periods that are removed at both ends.
// Throws InputError with fewer than six periods.
TimeSeries settled(TimeSeries const&, double corner_hz);
// rms of the integrated record between a high pass at half of corner_hz and one at corner_hz: motion, or noise of the
// sensor, right below the corner. NaN with fewer than six periods of half the corner.
double rms_below(TimeSeries const&, int times, double corner_hz);
// From past samples only: trapezoidal rule behind a causal Butterworth high pass of order 2 times + 2 at corner_hz,
// with the phase of that filter. Settles within a few 1/corner_hz. The trapezoidal rule multiplies by (x cot x)^times,
// x = pi f/rate: for two integrations 1 % too small at 1/26 of the rate.
TimeSeries integrated_causal(TimeSeries const&, int times, double corner_hz);

}  // namespace straytrace::spectra
