// SPDX-License-Identifier: BSD-3-Clause
// Lines that a shaker or loudspeaker drives: frequency, amplitude and phase over time, with errors (requirements.md
// R6.03).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "signal/series.hpp"

namespace straytrace {

// A stretch under a Hann window. Line: x = Re[a exp(2 pi i f (t - middle))], |a| its PEAK amplitude.
class LineWindow {
 public:
  LineWindow(std::span<double const> samples, double rate);

  std::complex<double> at(double hz) const;  // a
  // Standard error of each quadrature of `at` from the noise beside the line: sqrt(S ENBW), S the mean one-sided PSD 3
  // to 10 resolutions away on both sides, and not within 3 of the next harmonics, which are `spacing` away.
  double sigma(double hz, double spacing) const;
  // Where |a| is largest within the band [Hz]; `sigma`: standard error for a line of this amplitude in that noise.
  double peak(double low_hz, double high_hz) const;
  double peak_sigma(double amplitude, double sigma) const;
  double resolution() const { return rate_ / double(samples_.size()); }  // Hz

 private:
  std::vector<double> samples_;  // under the window, without their mean
  double rate_, sum_ = 0;
};

struct LinePoint {
  double time = 0;  // GPS s, middle of the window
  double hz = 0, hz_sigma = 0;
  std::complex<double> amplitude;  // peak
  double sigma = 0;                // of each quadrature, and of |amplitude| where it is well above
};

struct LineBand {
  double low = 0, high = 0;  // Hz
  double window = 4;         // s
};
// Noise is seen between harmonics: windows hold at least `fewest_periods` of the line.
constexpr double fewest_periods = 8;
// One point for each half-overlapping window, whether the line stands out or not. Throws InputError for a band outside
// (0, rate/2) or a window longer than the series or too short for the line.
std::vector<LinePoint> track_line(TimeSeries const&, LineBand const&);
// Amplitudes of another channel at harmonic n of the tracked frequencies, on the same samples.
std::vector<LinePoint> follow_line(TimeSeries const&, std::span<LinePoint const> track, double window,
                                   int harmonic = 1);

}  // namespace straytrace
