// SPDX-License-Identifier: BSD-3-Clause
// Motion of bodies on regular samples of time, and the sum of the phases of paths that move with it.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "motion/motion.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// Motion of the bodies in time: one realisation on regular samples.

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

// Sum of many fields whose phases move: the coherent mode (docs/develop/performance.md).

// Input of a sum over paths; phases in turns (1 turn = 2 pi).
struct PhaseTerms {
  std::vector<double> amplitude, turns;             // of each path: root of its power, static phase
  std::vector<double> phase_sensitivity;            // [path * coordinates + c], turns per metre or radian
  std::vector<std::span<double const>> coordinate;  // samples of each, m or rad; all as long

  std::size_t paths() const { return amplitude.size(); }
};

// s_n = sum_j a_j exp(2 pi i (turns_j + sum_c J_jc x_c(t_n))), exact to 1e-15 of each term times the number of
// turns. Paths moved by only one coordinate are a function of that coordinate: where that is cheaper they come from
// a table over its range, good to 2e-11 of sum |a_j|. The same bits for any number of threads (0: all cores).
// `direct`: what sums without tables, for example on a device; none: direct_phase_sum. `progress`: the completed
// share, 0 to 1, now and then, by the calling thread; not for work of `direct`.
using DirectSum = std::function<std::vector<std::complex<double>>(PhaseTerms const&)>;
using SumProgress = std::function<void(double share)>;
std::vector<std::complex<double>> phase_sum(PhaseTerms const&, unsigned threads = 0, DirectSum const& direct = {},
                                            SumProgress const& progress = {});

// The same without tables.
std::vector<std::complex<double>> direct_phase_sum(PhaseTerms const&, unsigned threads = 0,
                                                   SumProgress const& progress = {});

// Predicted fringe frequencies over time (docs/theory/spectra.md, eq. 7.1): arches of a spectrogram, storms (R6.10).

// N 2|v|/lambda [Hz] of a velocity [m/s] along the beam; N equal bounces at normal incidence. The base frequency: the
// light at this frequency is the first order of the fringe, whatever the amplitude.
std::vector<double> fringe_frequency(std::span<double const> velocity, double wavelength, double bounces);

// Effective number of normal-incidence bounces of a route on a body: |translation phase sensitivity|/2k, mean and
// standard deviation over its paths by power.
struct Multiplicity {
  BodyId body;
  double bounces = 0, spread = 0;  // 0 of modulated light
};

struct FringeCurve {
  std::uint32_t route = 0;
  std::string name;
  std::vector<Multiplicity> bodies;  // those that move, largest first
  std::vector<double> hz;  // |dphi/dt|/2pi with the mean phase sensitivities of the route, all bodies together
};
FringeCurve fringe_curve(CouplingTable const&, std::uint32_t route, MotionSeries const&);

struct FringeCurves {
  std::vector<FringeCurve> curves;  // of routes that move, the largest coupling first
  std::vector<double> largest;      // Hz, of these curves, sample by sample
  std::size_t left_out = 0;         // routes of lower coupling
};
// The curves of `most` of these routes.
FringeCurves fringe_curves(CouplingTable const&, std::span<std::uint32_t const> routes, MotionSeries const&,
                           std::size_t most);
// The frequencies of the same routes from another table and motion: those of with_delays().
void take_frequencies(FringeCurves&, CouplingTable const&, MotionSeries const&);

// A frequency in one stride of time.
struct FringeStride {
  double from = 0, to = 0;                  // GPS s
  double median = 0, p95 = 0, largest = 0;  // Hz
  double share_above = 0;                   // of the samples, above the threshold
};
// Strides of equal length; the last may be shorter. threshold [Hz].
std::vector<FringeStride> by_stride(std::span<double const> hz, SampleTimes const&, double stride, double threshold);

// Stretches of strides in which the frequency passes the threshold.
struct StretchAbove {
  double from = 0, to = 0, largest = 0;  // GPS s, Hz
};
std::vector<StretchAbove> stretches_above(std::span<FringeStride const>, double threshold);

}  // namespace straytrace::noise
