// SPDX-License-Identifier: BSD-3-Clause
// How fast a run learns: 1/(relative error^2 x seconds of tracing). It depends on machine and load, so it stands in
// /timing and is printed, but is no part of a result (docs/theory/errors.md).
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace {

struct Merit {
  std::string what;  // "receiver PD", "port ITM", or a route
  double value = 0;  // 1/s; NaN: unresolved, or nothing was timed
};

// Ends first, then the routes to ports by coupling, then those to receivers by power.
std::vector<Merit> merits(RunContent const&);
// A line each for all ends and the first `routes` routes; those without a value are left out.
std::string merit_text(std::vector<Merit> const&, std::size_t routes);

}  // namespace straytrace
