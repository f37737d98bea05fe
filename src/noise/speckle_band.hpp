// SPDX-License-Identifier: BSD-3-Clause
// Spread of one realisation of the unknown static phases around the mean (physics.md section 10,
// docs/theory/spectra.md).
#pragma once

#include "noise/noise.hpp"

namespace straytrace {

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

}  // namespace straytrace
