// SPDX-License-Identifier: BSD-3-Clause
// Motion of the bodies in time: one realisation on regular samples.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "motion/motion.hpp"

namespace straytrace::noise {

struct SampleTimes {
  double start = 0;  // GPS s
  double rate = 0;   // Hz
  std::size_t samples = 0;

  double duration() const { return static_cast<double>(samples) / rate; }  // s
};

// One coordinate of a body, as Gain::axis counts them.
struct MovingCoordinate {
  BodyId body;
  int axis = 0;
  std::vector<double> position;  // m or rad
  std::vector<double> velocity;  // m/s or rad/s, of the same samples
};

struct MotionSeries {
  SampleTimes times;
  std::vector<MovingCoordinate> coordinates;  // all moving ones, by body and axis
  LightModulation light = {};                 // of amplitudes
};

// Gaussian inputs: Fourier coefficients of independent normal real and imaginary parts, of a period of at least the
// record; the mean power of each is the exact integral of the spectrum over its bin. Motion slower than half a bin is
// a static phase and is omitted. The same seed, realisation and duration draw the same motion at twice the rate.
// Tones: Im(value exp(+2 pi i f t)), t from the start of the record. Drifts begin at zero there. Recorded inputs are
// read at the times of the samples (GPS), low-passed when they were sampled faster. Throws InputError when a recorded
// input does not cover the record or an input moves at half the rate or faster.
MotionSeries draw_motion(MotionSet const&, SampleTimes const&, std::uint64_t seed, std::uint32_t realisation = 0);

// Hz; the highest frequency of any motion except recordings, which are low-passed to fit the rate.
double highest_motion(MotionSet const&);

// The recorded series at times of another clock, band-limited by a Kaiser window of 32 samples on either side.
std::vector<double> resampled(TimeSeries const&, SampleTimes const&);

// Records made periodic, so that linear systems act on them by one transform.

// `period` samples: x, then a smooth way from its last value back to its first.
std::vector<double> made_periodic(std::span<double const> x, std::size_t period);

// Linear system on one period of a real series: `response` in the convention of the tree, exp(-2 pi i f t), at k * rate
// / n for k > 0; at f = 0 it is `at_zero`. `n` even.
std::vector<double> filtered(std::vector<double> const& x, double rate,
                             std::function<std::complex<double>(double hz)> const& response, double at_zero = 0);

// Series of n samples from the coefficients c_k of exp(+2 pi i k i/n), 0 < k < n/2: x = 2 Re sum c_k exp(...).
std::vector<double> synthesised(std::vector<std::complex<double>> const& coefficients, std::size_t n);

}  // namespace straytrace::noise
