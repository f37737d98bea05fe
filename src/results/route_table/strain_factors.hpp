// SPDX-License-Identifier: BSD-3-Clause
// The factors that make the strain noise of a route at one frequency: h^2(f) = C C_rev N (|T_phase|^2 +
// |T_amplitude|^2) S(f) (docs/theory/spectra.md, eq. 7.2, section 9).
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::results {

struct StrainFactor {
  char const* name;
  double value;
  char const *unit, *meaning;
  bool upper_bound = false;
};

struct StrainFactors {
  double centre = 0, low = 0, high = 0;  // Hz, of the bin
  std::vector<StrainFactor> factors;     // from the coupling C to h
  WithError h;                           // 1/sqrt(Hz)
  bool sampled = true;                   // with a Monte-Carlo error
  bool resolved = true;
  std::string why_not;
  double linear_share = 0;  // of the power, to first order in the motion of the bin
};

// Throws InputError for a frequency outside the grid of the budget.
StrainFactors strain_factors(CouplingTable const&, NoiseBudget const&, PathRow const&, Interferometer const&,
                             double hz);

}  // namespace straytrace::results
