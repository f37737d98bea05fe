// SPDX-License-Identifier: BSD-3-Clause
// Spread of one realisation of the unknown static phases around the mean (docs/theory/spectra.md,
// docs/theory/spectra.md).
#pragma once

#include <Eigen/Dense>

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "noise/noise.hpp"

namespace straytrace::noise {
// Fills speckle_05, _50, _95 and `coherent` of the budget, from the routes that make its total.
//
// Linear coupling: all paths that one input moves make one complex amplitude, whatever their route and port, so the law
// is that of a Gaussian vector with one element per independent input, and exact. Routes whose fringes wrap are treated
// alike, with the directions of their motion weighed over all frequencies: paths that differ in strength then average
// faster than this says, and the spread is an upper bound. Routes with few fixed paths (ghosts, edges) have a known
// modulus and an unknown phase.
void add_speckle_band(NoiseBudget&, CouplingTable const&, MotionSet const&, Interferometer const&);

// How much of one static phase survives in the spectrum of a route: 1: the phase decides which quadrature moves; 0:
// slow motion turns the field through all phases, both quadratures always count. exp(-2 x) for Gaussian motion of
// mean-square phase x: exact for x << 1 and x >> 1; 1 where tones move it, 0 where it drifts.
double surviving_phase(double gaussian_mean_square, double tone_mean_square, bool drifts);

// What Gaussian amplitudes of many inputs do together, in independent parts (docs/theory/spectra.md).

// Second moments of the complex amplitudes of some inputs: E H H^+ and E H H^T. Routes tie inputs together; inputs of
// different blocks have no moments in common, so that the work grows with the cube of the largest block alone.
struct SpeckleMoments {
  Eigen::MatrixXcd gamma, relation;
};

// An independent part of the vector of one block: its variance, and its unit direction, real parts before imaginary
// parts.
struct SpeckleMode {
  double weight;
  std::size_t block;
  Eigen::VectorXd direction;
};

// Of all blocks, the largest first. Without directions, which take most of the time, those of the modes are empty.
std::vector<SpeckleMode> modes_of(std::vector<SpeckleMoments> const& blocks, bool directions);

// One realisation against the speckle mean (docs/theory/spectra.md).

// Power |sum of fields|^2 of one speckle that a share `below` of the realisations stays under, over its mean; eq. 10.2.
double speckle_percentile(double below);

// Percentiles of sums of squares of Gaussian variables and of phasors, by a fixed low-discrepancy set of draws.

// |g + p|^2 of a real vector: g Gaussian, p the sum of phasors whose phases are unknown.
struct RandomVector {
  std::vector<std::vector<double>> gaussian;  // columns; g = sum over columns of column times a standard normal
  // p = sum of first * cos(phase) + second * sin(phase)
  std::vector<std::pair<std::vector<double>, std::vector<double>>> phasors;
};

class Draws {
 public:
  Draws();
  // 5th, 50th and 95th percentile of the sum of `copies` independent |g + p|^2. Directions beyond `most` count with
  // their mean.
  std::array<double, 3> percentiles(RandomVector const&, int copies) const;
  // The same for sum of weight times chi-square of one degree of freedom.
  std::array<double, 3> percentiles(std::vector<double> weights, int copies) const;

  static constexpr int count = 16384, most = 24;

 private:
  std::array<double, 3> read_off(std::vector<double>& values) const;
  std::vector<std::vector<double>> normal_, squared_, turn_;  // by direction and draw
};

}  // namespace straytrace::noise
