// SPDX-License-Identifier: BSD-3-Clause
// Sum of many fields whose phases move: the coherent mode (docs/develop/performance.md).
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "noise/time_domain/motion_series.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {
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
