// SPDX-License-Identifier: BSD-3-Clause
// The objects met by the light that rejoins the mode, ranked by the noise of their routes.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::results {

// Over all resolved routes that meet the object. A route counts once for every object that it meets.
struct MetObject {
  std::string object;             // empty: routes without names (too long, or too faint for a row of their own)
  WithError share;                // of the resolved strain noise power in the band of the table [1]; NaN without noise
  std::vector<WithError> strain;  // 1/sqrt(Hz), one per frequency of the table
  WithError coupling;             // of ordered paths; C_rev not multiplied in
  std::vector<std::size_t> routes;  // ranks in the table
};

// By share, without noise by coupling. Errors of routes of one trace are correlated as in ReplicaSum.
std::vector<MetObject> objects_by_noise(PathTable const&);

std::string port_census_text(PathTable const&, std::size_t show);
std::string port_census_csv(PathTable const&, RunContent const&);
std::string port_census_json(PathTable const&, RunContent const&);

}  // namespace straytrace::results
