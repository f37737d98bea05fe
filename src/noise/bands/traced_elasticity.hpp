// SPDX-License-Identifier: BSD-3-Clause
// Elasticities by traces at both ends of a step, of a size that balances truncation and Monte-Carlo error
// (docs/theory/decisions.md, Geometry).
#pragma once

#include "noise/bands/elasticity.hpp"

namespace straytrace::noise {

struct TracedElasticity {
  double step = 0;         // of the logarithm of the input, to either side
  BinValues elasticity;    // at this step; with `doubled` its error has the truncation
  double correlation = 0;  // of both ends: 1 - paired/independent variance, mean over the bins with noise
  BinValues monte_carlo;   // the same with the Monte-Carlo error alone
  BinValues doubled;       // at twice the step; empty: not traced
  BinValues extrapolated;  // from both by Richardson, of order 4; empty as well
};

using TracedTotal = std::function<NoiseTrace(double step)>;  // with the input times e^step

TracedElasticity traced_elasticity(TracedTotal const&, double step);
// With the step chosen (eq. D.16), from `start` on by factors of two, at most three; at the bin that needs the
// smallest.
TracedElasticity balanced_elasticity(TracedTotal const&, double start, std::vector<std::size_t> const& bins);

}  // namespace straytrace::noise
