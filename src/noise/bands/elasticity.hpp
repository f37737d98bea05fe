// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of h with respect to its inputs, and ratios of curves of the same histories (docs/theory/decisions.md).
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "noise/noise.hpp"

namespace straytrace::noise {

// One number for each bin, with one standard error, Monte Carlo only.
struct BinValues {
  std::vector<double> value, sigma;
};

// ln(a/b) of the ASDs of two totals. Where both come from the same histories (`paired`) the error is the jackknife of
// the ratio over the replicas (eq. D.2); otherwise the squares of their relative errors add. NaN where one is zero.
// `unresolved`: by how much the ratio may change with that share of unresolved light in both.
BinValues log_ratio(NoiseTrace const& a, NoiseTrace const& b, bool paired, double unresolved = 1);

// Sum of weights times ln of the ASDs of totals of the same histories, with its jackknife (eq. D.2). NaN where one is
// zero.
using WeightedTotals = std::vector<std::pair<double, NoiseTrace const*>>;
BinValues log_sum(WeightedTotals const&);

// d ln h/d ln p = 1/2 (dS/d ln p)/S from the projection of the derivative, which is linear in the couplings (eq. D.1),
// with the jackknife of the ratio. 0 where `derivative` is, NaN where the total is zero.
BinValues elasticity(NoiseTrace const& derivative, NoiseTrace const& total);

// d ln h/d ln p from projections with p times and over e^0.05 and e^0.1, paired; the error of its order is 4 (eq. D.3).
BinValues central_elasticity(std::function<NoiseTrace(double factor)> const& total);

// Factor on the coupling of a route, of its steps.
using RouteFactor = std::function<double(std::vector<PathStep> const&)>;

// Couplings with the light of each route times its factor; routes without light are left out. Kept paths of a row
// `other` have the factor of their own route; where that is not known, the mean of the named routes by coupling.
struct ScaledCouplings {
  CouplingTable table;
  std::vector<double> unknown;  // by class of the table before: share of its light whose factor is not known
};
ScaledCouplings scaled_couplings(CouplingTable const&, RouteFactor const&);

}  // namespace straytrace::noise
