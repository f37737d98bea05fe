// SPDX-License-Identifier: BSD-3-Clause
// Predicted fringe frequencies over time (docs/theory/spectra.md, eq. 7.1): arches of a spectrogram, storms (R6.10).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "noise/time_domain/motion_series.hpp"
#include "trace/coupling.hpp"

namespace straytrace {

// N 2|v|/lambda [Hz] of a velocity [m/s] along the beam; N equal bounces at normal incidence. The base frequency: the
// light at this frequency is the first order of the fringe, whatever the amplitude.
std::vector<double> fringe_frequency(std::span<double const> velocity, double wavelength, double bounces);

// How often a route sees a body, in bounces at normal incidence: |translation phase sensitivity|/2k, mean and standard
// deviation over its paths by power.
struct Multiplicity {
  BodyId body;
  double bounces = 0, spread = 0;
};

struct FringeCurve {
  std::uint32_t route = 0;
  std::string name;
  std::vector<Multiplicity> bodies;  // those that move, largest first
  std::vector<double> hz;  // |dphi/dt|/2pi with the mean phase sensitivities of the route, all bodies together
};
FringeCurve fringe_curve(CouplingTable const&, std::uint32_t route, MotionSeries const&);

// What a frequency does in one stride of time.
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

}  // namespace straytrace
