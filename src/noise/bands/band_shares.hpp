// SPDX-License-Identifier: BSD-3-Clause
// Shares of uncertain inputs in the input band of h where first order is not enough (docs/theory/decisions.md).
#pragma once

#include <vector>

#include "noise/bands/composition.hpp"
#include "noise/bands/input_band.hpp"

namespace straytrace::noise {

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
