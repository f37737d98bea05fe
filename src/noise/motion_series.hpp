// SPDX-License-Identifier: BSD-3-Clause
// What the bodies do in time: one realisation of their motion on regular samples.
#pragma once

#include <cstdint>
#include <vector>

#include "motion/motion.hpp"

namespace straytrace {

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
  std::vector<MovingCoordinate> coordinates;  // all that move, by body and axis
};

// Gaussian inputs: Fourier coefficients of independent normal real and imaginary parts, of a period of at least the
// record; the mean power of each is the exact integral of the spectrum over its bin. What is slower than half a bin is
// a static phase and is left out. The same seed, realisation and duration draw the same motion at twice the rate.
// Tones: Im(value exp(+2 pi i f t)), t from the start of the record. Drifts begin at zero there. Recorded inputs are
// read at the times of the samples (GPS), low-passed when they were sampled faster. Throws InputError when a recorded
// input does not cover the record or an input moves at half the rate or faster.
MotionSeries draw_motion(MotionSet const&, SampleTimes const&, std::uint64_t seed, std::uint32_t realisation = 0);

// Hz; the highest frequency at which anything moves, recordings aside: they are low-passed as the rate wants.
double highest_motion(MotionSet const&);

// The recorded series at times of another clock, band-limited by a Kaiser window of 32 samples on either side.
std::vector<double> resampled(TimeSeries const&, SampleTimes const&);

}  // namespace straytrace
