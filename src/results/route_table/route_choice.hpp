// SPDX-License-Identifier: BSD-3-Clause
// Rows of the path table by filter and order, and the sums without objects: --where, --sort, --without of `paths`.
#pragma once

#include <string>
#include <vector>

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

}  // namespace straytrace::results
