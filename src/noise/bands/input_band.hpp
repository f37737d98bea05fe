// SPDX-License-Identifier: BSD-3-Clause
// Effect of uncertain scatter and uncertain motion on the total (docs/theory/errors.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "noise/bands/elasticity.hpp"

namespace straytrace::noise {

// Fills the input band of the total and of each route, its sources and `taken_as_exact`. Brackets of all materials go
// to their low ends together and to their high ends together; standard deviations of materials and of motions combine
// in quadrature of their logarithms. Motion is projected anew with each uncertain body at its low and high end. NaN
// where routes of unknown composition exceed composition_limit: of a row, or of the total.
void add_input_band(NoiseBudget&, CouplingTable const&, MotionSet const&, Interferometer const&, NoiseSettings const&,
                    std::vector<MaterialSpread> const&);

// Inputs of motion that move the same bodies: they come from one measurement and are varied together.
struct MotionCause {
  std::string name;                 // "motion of tube, tower"
  std::vector<std::size_t> inputs;  // of the motion set
  double uncertainty = 1;           // largest of them: one sigma, factor on the ASD
};
std::vector<MotionCause> motion_causes(MotionSet const&);
// The ASD of each input of a cause times `factor` of its own uncertainty.
MotionSet with_scaled_inputs(MotionSet const&, MotionCause const&,
                             std::function<double(double uncertainty)> const& factor);

// Shares of uncertain inputs in the input band of h where first order is not enough (docs/theory/decisions.md).

// The PSD as a function of the logarithms t of uncertain inputs: the materials, then the motions (eq. D.12).
struct UncertainPsd {
  using Spectra = std::vector<std::vector<double>>;  // [term][bin]
  struct Motion {
    std::vector<double> nodes;    // of t, evenly spaced
    std::vector<Spectra> ln_psd;  // [node]
  };
  std::vector<std::vector<int>> exponents;  // [term][material]
  Spectra psd;
  std::vector<Motion> motions;
  std::vector<double> sigma;       // standard deviation of each t
  std::vector<bool> not_additive;  // bins where the motions change the PSD otherwise together than one by one

  std::size_t bins() const { return psd.empty() ? 0 : psd.front().size(); }
};

// `materials` and `causes`: those with a standard deviation. The motion of each cause is projected up to four standard
// deviations, the other causes as they are; their changes of the PSD are added.
UncertainPsd uncertain_psd(CouplingTable const&, std::vector<MaterialSpread> const& materials, MotionSet const&,
                           std::vector<MotionCause> const& causes, Interferometer const&, NoiseSettings const&);

struct BandShares {
  std::vector<bool> sampled;                 // per bin; all else is meaningless in the others
  std::vector<double> band;                  // standard deviation of ln h; NaN where motions do not add
  std::vector<std::vector<double>> share;    // [input][bin]: first-order Sobol index of ln h
  std::vector<std::vector<double>> halving;  // [input][bin]: relative narrowing of the band with half its sigma
};
// Where first order fails, by 2^13 points of Sobol's sequence. `linear`: the band to first order, per bin (eq. D.13).
BandShares sampled_shares(UncertainPsd const&, std::vector<double> const& linear);

}  // namespace straytrace::noise
