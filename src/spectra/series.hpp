// SPDX-License-Identifier: BSD-3-Clause
// A regularly sampled record of one channel.
#pragma once

#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::spectra {

// Shortest and longest sample step, s. Others are mistakes of units.
inline constexpr double shortest_step = 1e-12, longest_step = 1e12;

struct TimeSeries {
  std::string name;             // of the channel, for messages and files
  std::string unit;             // of the samples, as parse_unit reads it: "m", "m/s^2", "count"; "1" for strain
  double start = 0;             // GPS time of the first sample, s; 0.2 us is the resolution of a double
  double rate = 0;              // Hz
  std::vector<double> samples;  // in `unit`

  double duration() const { return static_cast<double>(samples.size()) / rate; }  // s
  double end() const { return start + duration(); }                               // GPS time after the last sample
  double time(std::size_t i) const { return start + static_cast<double>(i) / rate; }
};

// Stretch of GPS time, s; infinite ends: the whole record.
struct GpsSpan {
  double from = -1e300, to = 1e300;
};

// The samples within the span. Throws InputError with the available times when the series does not cover it.
TimeSeries cut(TimeSeries const&, GpsSpan);
// Stretches that all series cover, on the samples of the slowest: faster ones are low-passed and decimated by a whole
// factor. Throws InputError when they do not overlap or no whole factor fits.
std::vector<TimeSeries> aligned(std::vector<TimeSeries> const&);

// Interpolation of a series.

// Values at first, first + 1/rate, ... (GPS s): sinc of 32 samples under a Kaiser window, right to 1e-5 of the
// amplitude for content below 0.8 of half the series' own rate; on a sample, the sample itself. Point reflection
// continues the series beyond its ends. Throws InputError for times more than 16 samples outside.
std::vector<double> interpolated(TimeSeries const&, double first, double rate, std::size_t count);

}  // namespace straytrace::spectra
