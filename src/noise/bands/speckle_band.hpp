// SPDX-License-Identifier: BSD-3-Clause
// Spread of one realisation of the unknown static phases around the mean (docs/theory/spectra.md).
#pragma once

#include <array>
#include <vector>

#include "noise/noise.hpp"

namespace straytrace::noise {
// Fills speckle_05, _50, _95 and `coherent` of the budget, from the routes that make its total.
//
// Linear coupling: all paths moved by one input form one complex amplitude, for any route and port, so the distribution
// is exactly that of a Gaussian vector with one element per independent input. Routes with wrapped fringes are treated
// likewise, with the directions of their motion weighted over all frequencies: paths of different strength average
// faster than that, so the spread is an upper bound. Routes with few fixed paths (ghosts, edges) have a known
// modulus and an unknown phase.
void add_speckle_band(NoiseBudget&, CouplingTable const&, MotionSet const&, Interferometer const&);

// Effect of the static phase on the spectrum of a route: 1: the phase selects the quadrature that moves; 0: slow motion
// turns the field through all phases, so both quadratures always contribute. exp(-2 x) for Gaussian motion of
// mean-square phase x: exact for x << 1 and x >> 1; 1 where tones move it, 0 where it drifts.
double surviving_phase(double gaussian_mean_square, double tone_mean_square, bool drifts);

// One realisation against the speckle mean (docs/theory/spectra.md).

// Percentile `below` of the power |sum of fields|^2 of one speckle, over its mean; eq. 10.2.
double speckle_percentile(double below);

// Percentiles of sums of squares of Gaussian variables and of phasors, by a fixed low-discrepancy set of draws.

// |g + p|^2 of a real vector: g Gaussian, p the sum of phasors whose phases are unknown.
struct RandomVector {
  std::vector<std::vector<double>> gaussian;  // columns; g = sum over columns of column times a standard normal
  // p = sum of first * cos(phase) + second * sin(phase)
  std::vector<std::pair<std::vector<double>, std::vector<double>>> phasors;
  double rest = 0;  // mean square of further parts, which counts with its mean
};

class Draws {
 public:
  Draws();
  // 5th, 50th and 95th percentile of the sum of `copies` independent |g + p|^2. Directions beyond `most` count with
  // their mean.
  std::array<double, 3> percentiles(RandomVector const&, int copies) const;
  // The same for sum of weight times chi-square of one degree of freedom, and `rest`, which counts with its mean.
  std::array<double, 3> percentiles(std::vector<double> weights, int copies, double rest = 0) const;

  static constexpr int count = 16384, most = 24;

 private:
  std::array<double, 3> read_off(std::vector<double>& values) const;
  std::vector<std::vector<double>> normal_, squared_, turn_;  // by direction and draw
};

}  // namespace straytrace::noise
