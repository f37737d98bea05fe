// SPDX-License-Identifier: BSD-3-Clause
// Errors of sums over routes. Routes share histories, and a route may carry the numbers of its reverse: then they go up
// and down together, and the squares of their errors do not simply add up. What they have in common is seen in the
// replicas of the trace (docs/theory/errors.md, errors of sums).
#pragma once

#include <array>

#include "report/report.hpp"

namespace straytrace {

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
  double independent_ = 0;  // variance of what has no pattern
};

}  // namespace straytrace
