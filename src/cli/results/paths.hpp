// SPDX-License-Identifier: BSD-3-Clause
// Which rows `paths` shows: --where, --without, --sort.
#pragma once

#include <string>
#include <vector>

#include "results/route_table/route_sums.hpp"

namespace straytrace::cli {

struct PathsChoice {
  std::string where, sort;
  std::string band;                  // of shares and ranks: "10 Hz..100 Hz"; empty: all frequencies
  std::vector<std::string> without;  // patterns of objects
  bool any() const { return !where.empty() || !sort.empty() || !without.empty() || !band.empty(); }
};

struct ChosenPaths {
  PathTable all, shown;               // `all`: without what --without leaves out
  std::vector<StrainWithout> strain;  // of --without
  std::size_t left_out = 0;
  WithError coupling_before;  // of --without
  std::vector<std::string> notes;
};

// Throws InputError with all that is wrong in the three options.
ChosenPaths choose_paths(PathsChoice const&, PathTable const&, CouplingTable const&, NoiseBudget const*);

// What the options did, in lines: for people above the table, for `#` lines of CSV.
std::string choice_text(PathsChoice const&, ChosenPaths const&);
// The same as members "where", "sort", "without" of the JSON text of a table.
std::string with_choice(std::string const& json, PathsChoice const&, ChosenPaths const&);

}  // namespace straytrace::cli
