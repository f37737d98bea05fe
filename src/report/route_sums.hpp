// SPDX-License-Identifier: BSD-3-Clause
// Path tables of some of the routes: those a filter lets through, or those that are left when an object is absent.
#pragma once

#include <vector>

#include "report/report.hpp"

namespace straytrace {

// Ranks, verdicts and sums of what `rows` holds. With `shares` of their own noise power; else those they have.
void rank_and_sum(PathTable&, bool shares);

// These rows, in this order, resolved ones first; ranks, shares and total_strain are those of the whole table.
PathTable part_of(PathTable const&, std::vector<std::size_t> const& rows);

// What leaving routes out does to the total at one frequency [Hz].
struct StrainWithout {
  double hz = 0;
  WithError before, after;  // 1/sqrt(Hz); `after` NaN when no resolved route is left
  WithError factor;         // after/before; what both have in common is in neither error twice
};

struct Without {
  PathTable rest;  // ranks, shares and totals of what is left
  std::vector<StrainWithout> strain;
};

// `left_out`: rows. The noise of a route that is left out is taken away; what its light would do instead is not known.
Without without_rows(PathTable const&, std::vector<std::size_t> const& left_out, CouplingTable const&,
                     NoiseBudget const*);

// Sum line and lines `further routes` are about the rows of `part`, shares are of `all`.
std::string path_text(PathTable const& part, std::size_t show, PathTable const& all);

}  // namespace straytrace
