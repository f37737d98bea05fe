// SPDX-License-Identifier: BSD-3-Clause
// The noise of a run as a polynomial of the strengths of its BSDFs, and as a function of the motion of one body: what
// the sliders of a report need (docs/theory/decisions.md, eq. D.8 to D.11).
#pragma once

#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <vector>

#include "results/results.hpp"
#include "session/model.hpp"

namespace straytrace::session {

using Spectrum = std::vector<double>;  // per bin

struct WhatIfTerms {
  struct Material {
    std::string name;
    double most = 1;  // factor at which it scatters, reflects and transmits all light
  };
  // A body whose motion is scaled, all others as they are. Paths that make less than 1e-3 of the noise follow the
  // others.
  struct Moved {
    std::string name;
    std::vector<double> factors;       // empty: the PSD is quadratic in the factor, and the ratio is that at rest
    std::vector<std::size_t> of_term;  // which ratio a term has
    std::vector<std::vector<Spectrum>> ratio;  // [ratio][factor, or 0][bin]: PSD over that as traced
  };
  // A row of the path table: a route has one part, a row `other` one of each term that it has light of.
  struct Row {
    std::uint64_t hash = 0;
    std::string name;  // "ITM·S > baffles·S > ITM·S"
    std::vector<std::size_t> terms;
    std::vector<std::vector<double>> psd;  // [part][place]: in the bins of `frequencies`, then the sum over the band
  };

  std::string none;    // why there are no sliders; all else is empty then
  double unnamed = 0;  // largest share of the noise power, over bins, of light whose scatters are not counted
  std::vector<Material> materials;
  std::vector<std::vector<int>> exponents;                    // [term][material]
  std::vector<Spectrum> psd;                                  // [term][bin], strain^2/Hz, as traced
  std::vector<std::array<double, replica_count>> deviations;  // [term][replica], relative
  Spectrum error_factor;                                      // of h of the run over that by the deviations
  Spectrum error_kept;  // relative, of h, in bins whose error the deviations do not have
  std::vector<Moved> moved;
  std::vector<Row> rows;
  std::vector<double> frequencies;    // Hz
  std::vector<std::string> left_out;  // what has no slider, with the reason
};

// `rows`: of the table, by rank.
WhatIfTerms what_if_terms(Model const&, CouplingTable const&, NoiseBudget const&, PathTable const&, std::size_t rows);

// For data/page/what_if.js: PSDs over that of the total as traced.
nlohmann::json what_if_json(WhatIfTerms const&, NoiseBudget const&, PathTable const&);

// The most that a material can scatter, over what it does, and the incidence at which that is reached.
struct LargestFactor {
  double factor = infinity, degrees = 0;
  double scattered = 0, others = 0;  // shares of the light there: scattered now; reflected and transmitted
};
LargestFactor largest_factor(World const&, std::string const& material);

}  // namespace straytrace::session
