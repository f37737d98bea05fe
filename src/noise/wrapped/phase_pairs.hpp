// SPDX-License-Identifier: BSD-3-Clause
// Fields whose static phases are known: coherent families (docs/theory/ghosts.md, eq. 10.5).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace {

// One term weight * exp(-(own R(0) - cross R(tau))) of a correlation, summed over the classes in the exponent; a tone
// is a factor J_0(sqrt(2 own - 2 cross cos(2 pi f tau))), a drift that both paths share a factor cos(sqrt(own) tau).
// own = cross = kappa is a path by itself (eq. 1.11). PSDs of motion come in through kappa, so that part of a
// cross-covariance that is odd in tau is left out: nothing, unless two paths see one input through transfers of
// different phase.
struct PhasePair {
  double weight = 1;
  std::vector<double> own, cross;  // per class; |cross| <= own
};

// Averages over the bins of the grid of the one-sided PSD, 1/Hz; single terms may be negative. Zero: below what a
// transform resolves.
struct PairSpectrum {
  std::vector<double> psd;
  std::vector<double> linear;  // of it: first order in the motion of the bin, as in PhaseSpectrum; between 0 and psd
  double constant =
      0;  // power at f = 0; with all psd the sum of the weights over two, times one less cross/own at tau = 0
};
// Slow motion by one transform, weak fast motion to first order (eq. 7.14). Of two paths that drift apart the term is
// left out: the mean of its phase over a long time is zero.
PairSpectrum pair_spectrum(PhaseSpectra const&, std::span<PhasePair const>);

// A specular path: its field, root of its recoupled power times exp(i phase), and its phase sensitivities.
struct CoherentPath {
  std::complex<double> field;
  std::vector<PhaseSensitivity> phase_sensitivities;
};
// Fields added, the common phase averaged. At most `most_coherent` paths.
constexpr std::size_t most_coherent = 64;
std::vector<PhasePair> coherent_family(MotionSet const&, std::vector<MotionClass> const&,
                                       std::span<CoherentPath const>);

}  // namespace straytrace
