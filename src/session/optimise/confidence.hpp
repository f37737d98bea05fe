// SPDX-License-Identifier: BSD-3-Clause
// Whether a curve lies below a line in all bins at once (docs/theory/optimisation.md, eq. O.2).
#pragma once

#include <vector>

#include "noise/noise.hpp"
#include "results/results.hpp"

namespace straytrace::session {

// Factor on the standard errors with which all of these bins are upper limits at once. `deviations`: of each bin by
// each replica, [replica][bin]. Of one bin the quantile of Student's t; of more the distribution of the largest of the
// correlated errors, from a fixed set of Gaussian multipliers.
double factor_of_all(std::vector<std::vector<double>> const& deviations, double confidence);

struct LineVerdict {
  double excess = not_a_number;                 // logarithm of the largest upper limit over the line: met at 0 or below
  WithError ratio{not_a_number, not_a_number};  // of the curve to the line in that bin, with its standard error
  double hz = not_a_number, factor = not_a_number;
  std::vector<double> deviations{};  // of the logarithm of the curve there, by replica
};
// Of the total, in which the observed power of unresolved routes counts tenfold. `line`: ASD per bin, NaN: not
// compared. Without a bin the excess is NaN.
LineVerdict compared(NoiseBudget const&, std::vector<double> const& line, double confidence);

}  // namespace straytrace::session
