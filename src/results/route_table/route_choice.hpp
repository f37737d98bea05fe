// SPDX-License-Identifier: BSD-3-Clause
// Rows of the path table by filter and order, and the sums without objects: --where, --sort, --without of `paths`.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"
#include "results/route_table/route_sums.hpp"

namespace straytrace::results {

struct PathsChoice {
  std::string where, sort;
  std::vector<std::string> without;  // patterns of objects
  bool any() const { return !where.empty() || !sort.empty() || !without.empty(); }
};

struct ChosenPaths {
  PathTable all, shown;               // `all`: except rows removed by --without
  std::vector<StrainWithout> strain;  // of --without
  std::size_t left_out = 0;
  WithError coupling_before;  // of --without
  std::vector<std::string> notes;
};

// Throws InputError with all problems of the three options.
ChosenPaths choose_paths(PathsChoice const&, PathTable const&, CouplingTable const&, NoiseBudget const*);

// Effect of the options, in lines: above the table, and as `#` lines of CSV.
std::string choice_text(PathsChoice const&, ChosenPaths const&);
// The same as members "where", "sort", "without" of the JSON text of a table.
std::string with_choice(std::string const& json, PathsChoice const&, ChosenPaths const&);

// The objects met by the light that rejoins the mode, ranked by the noise of their routes.

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
