// SPDX-License-Identifier: BSD-3-Clause
// Path tables of some of the routes, and factors from the stray field of a route to strain.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::results {

// Path tables of some of the routes: those that pass a filter, or those that remain without an object.

// Ranks, statuses and sums of `rows`. With `shares`, shares of their own noise power; else those they have.
void rank_and_sum(PathTable&, bool shares);

// These rows, in this order, resolved ones first; ranks, shares and total_strain are those of the whole table.
PathTable part_of(PathTable const&, std::vector<std::size_t> const& rows);

// Effect on the total of removing routes, at one frequency [Hz].
struct StrainWithout {
  double hz = 0;
  WithError before, after;  // 1/sqrt(Hz); `after` NaN when no resolved route is left
  WithError factor;         // after/before; the correlation of both is included
};

struct Without {
  PathTable rest;  // ranks, shares and totals of the rest
  std::vector<StrainWithout> strain;
};

// `left_out`: rows. The noise of a removed route is subtracted; the further path of its light is unknown.
Without without_rows(PathTable const&, std::vector<std::size_t> const& left_out, CouplingTable const&,
                     NoiseBudget const*);

// Position of the route of a row among the classes; InputError when the table does not have it.
std::size_t class_of(CouplingTable const&, PathRow const&);

// Sum line and lines `further routes` are about the rows of `part`, shares are of `all`.
std::string path_text(PathTable const& part, std::size_t show, PathTable const& all);

// Errors of sums over routes. Routes share histories, and a route may carry the numbers of its reverse: then they are
// correlated, and the squares of their errors do not simply add. The replicas of the trace contain the
// correlation (docs/theory/errors.md, errors of sums).

// Deviations of a route's coupling from its mean in the replicas, scaled so that their squares add up to 1; zeros: some
// replica has no histories, or all have the same sum.
ReplicaPattern pattern_of(CouplingTable const&, CouplingClass const&);

// A number with its deviation in each replica, in its own unit: their squares add up to its variance.
class ReplicaSum {
 public:
  ReplicaSum() = default;
  // `sigma`: one standard error of the value; it goes up and down as the pattern does. A pattern of zeros: independent
  // of all else.
  ReplicaSum(WithError value, ReplicaPattern const& pattern);

  void add(ReplicaSum const& other);
  WithError result() const;
  double value() const { return value_; }
  // This over a total that this is part of; NaN when the total is not positive.
  WithError share_of(ReplicaSum const& total) const;

 private:
  double value_ = 0;
  ReplicaPattern off_ = {};
  double independent_ = 0;  // variance of the terms without pattern
};

// "#1 #3 #4": the first of the ranks of some routes, for people, and how many more there are.
std::string first_ranks(std::vector<std::size_t> const&);

// Figures of merit: efficiency of a run, 1/(relative error^2 x seconds of tracing). They depend on machine and load:
// printed and stored in /timing, but not part of a result (docs/theory/errors.md).

struct Merit {
  std::string what;  // "receiver PD", "port ITM", or a route
  double value = 0;  // 1/s; NaN: unresolved, or nothing was timed
};

// Ends first, then the routes to ports by coupling, then those to receivers by power.
std::vector<Merit> merits(RunContent const&);
// A line each for all ends and the first `routes` routes; those without a value are left out.
std::string merit_text(std::vector<Merit> const&, std::size_t routes);

// The factors that make the strain noise of a route at one frequency: h^2(f) = C C_rev N (|T_phase|^2 +
// |T_amplitude|^2) S(f) (docs/theory/spectra.md, eq. 7.2, section 9).

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
