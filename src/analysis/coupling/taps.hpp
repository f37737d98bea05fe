// SPDX-License-Identifier: BSD-3-Clause
// Tapping: a hammer with a force sensor strikes one place after another; the places are ranked by the response of the
// target (R6.02).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {

struct TapPlace {
  std::string name;
  double start = 0, duration = 0;  // GPS s, s
  std::string strength;            // "soft", "hard": only a label
  std::string file = {};           // the list, and where the start is in it
  Place at = {};
};
// CSV with a header: place, start, duration, optionally strength. Throws InputError with file and line.
std::vector<TapPlace> parse_tap_list(std::string_view csv, std::string const& file);

struct TapThresholds {
  double target = 3, force = 2;  // ratio of ASDs, taps over quiet
  double significance = 3;       // of the excess of the target
  double not_linear = 3;         // standard errors between the slope and 1
};

// One place at one frequency, all its repeats together.
struct TapAnswer {
  std::string place;
  int repeats = 1;
  double target_ratio = 0, force_ratio = 0;  // ASDs, taps over quiet; of the strongest repeat
  double ratio = 0, sigma = 0;               // target_ratio/force_ratio, mean of the repeats: ranks the places
  double coupling = 0, coupling_sigma = 0;   // target unit per unit of force, quiet levels subtracted
  double significance = 0;                   // of the excess of the target
  double slope = not_a_number,
         slope_sigma = not_a_number;  // of log target against log force over the repeats; 1: linear
  bool not_linear = false;
  std::string local;  // accelerometer with the largest rise, and the rise; empty without any
  double local_ratio = 0;
};

// Limit of a place whose taps did not raise the target above the noise.
struct TapLimit {
  std::string place;
  double coupling = 0;  // at most, at 95 % confidence of all its repeats together; target unit per unit of force
};

struct TapPeak {
  double hz = 0;
  std::vector<TapAnswer> places;  // ranked, the strongest first; without those below the thresholds
  std::vector<TapLimit> limits;   // of those above the threshold of the force and below that of the target
  double lead = not_a_number;     // standard errors between the first two, of the logarithm; NaN: only one
};

inline constexpr int fewest_tap_segments = 6;  // that a place holds

struct TapSeries {
  TimeSeries force, target;  // on equal samples; NaN at equal ones
  std::vector<TimeSeries> local;
};

// Peaks of the target over all places, by rising frequency. Errors: spread between the segments of a place (jackknife,
// so taps of different strength do not matter), and the averages of the quiet stretch. Throws InputError when a place
// holds too few segments or lies outside the data: all such places at once.
std::vector<TapPeak> tap_peaks(TapSeries const&, std::span<TapPlace const>, GpsSpan quiet, WelchSettings const&,
                               TapThresholds const&);

}  // namespace straytrace::analysis
