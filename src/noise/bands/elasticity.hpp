// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of h with respect to its inputs, its composition, and ratios of curves of the same histories
// (docs/theory/decisions.md).
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "noise/noise.hpp"

namespace straytrace::noise {

// Derivatives of h with respect to its inputs, and ratios of curves of the same histories (docs/theory/decisions.md).

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

// How often the light of each route scatters on uncertain materials; of rows that sum routes, by the noise of each
// (docs/theory/errors.md, The input band).

// Uncertainty of a material, as ratios to the traced value, and the groups that have it.
struct MaterialSpread {
  std::string name, status;
  double low = 1, high = 1;  // bracket: a range
  double factor = 1;         // one standard deviation of the logarithm
  bool of_reflection = false;
  std::vector<GroupId> groups;
};

// Number of scatters of a route on the material (of reflections, for its reflectance).
int scatters_on(MaterialSpread const&, std::vector<PathStep> const& steps);

// Factor on the coupling of a class when the BRDF of the material is `ratio` times the traced value: ratio^scatters.
// Of a row that sums routes: the mean over its named routes by coupling; `ratio` when none has a name.
double coupling_factor(MaterialSpread const&, CouplingClass const&, double ratio);
// Whether that is also the factor on its noise. A row `other` names its largest routes by coupling, while fainter ones
// on moving surfaces may make its noise, and fields of ghosts do not add in power: it is known only where all routes
// scatter equally often on the material.
bool composition_known(MaterialSpread const&, CouplingClass const&);
// Share of the PSD from which rows of unknown composition leave the effect of a material on the total unknown.
constexpr double composition_limit = 0.1;

// Routes of a row that scatter equally often on each material.
struct RowPart {
  std::vector<int> scatters;   // by material
  double share = 1;            // of the PSD of the row, times
  std::vector<double> of_bin;  // this, per bin; empty: 1
  bool by_coupling = false;    // the share is that of the coupling of named routes
  double at(std::size_t bin) const { return share * (of_bin.empty() ? 1 : of_bin[bin]); }
};

// The parts of each route of a table. A row `other` is divided by the noise of its kept paths, whose routes are known
// since schema 2.1 of run files; paths of unknown routes, and rows of ghosts whose fields add, by coupling.
class Composition {
 public:
  Composition(CouplingTable const&, std::vector<MaterialSpread> materials, MotionSet const&, Interferometer const&,
              NoiseSettings const&);

  // The shares sum to 1 in each bin.
  std::vector<RowPart> const& parts(std::size_t route) const { return parts_[route]; }
  // Factor on the PSD of a route in a bin when the BRDF of each material is `ratio` times the traced value.
  double factor(std::size_t route, std::size_t bin, std::span<double const> ratio) const;
  // The same for one material alone.
  double factor(std::size_t route, std::size_t bin, std::size_t material, double ratio) const;
  // Share of the PSD of a route in a bin that scatters an unknown number of times on the material.
  double unknown(std::size_t route, std::size_t bin, std::size_t material) const;

 private:
  std::vector<MaterialSpread> materials_;
  std::vector<std::vector<RowPart>> parts_;  // by route
  std::vector<std::vector<bool>> known_;     // by route, then by material: composition_known()
};

// Elasticities by traces at both ends of a step, of a size that balances truncation and Monte-Carlo error
// (docs/theory/decisions.md, Geometry).

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
