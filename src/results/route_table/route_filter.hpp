// SPDX-License-Identifier: BSD-3-Clause
// Filters of a path table: via("NE_bench/*") and scatters == 2 and h(30 Hz) > 1e-25, or plain words. The same
// language as in the filter of a report (data/page/filter.js); docs/reference/filter.md.
#pragma once

#include <string>
#include <vector>

#include "results/route_table/route_columns.hpp"

namespace straytrace::results {

// A problem at bytes [begin, begin + width) of a filter.
struct FilterProblem {
  std::size_t begin = 0, width = 1;
  std::string what, suggestion;
};

struct FilterAnswer {
  std::vector<std::size_t> rows;  // those let through, in the order of the table; empty where there are problems
  std::vector<FilterProblem> problems;
  std::vector<std::string> notes;  // patterns that match no route
};

FilterAnswer filtered(std::string_view text, RouteColumns&);

// Rows by a column, largest number first, texts and ranks from the first; unknown values come last.
// `key`: a name of the filter, h(30 Hz) among them. Problems as above.
FilterAnswer sorted_by(std::string_view key, std::vector<std::size_t> rows, RouteColumns&);

// Units of frequency that a filter accepts, with their factors to Hz.
std::vector<std::pair<std::string, double>> frequency_units();

// "--where, column 15: 'scaters' is not known", with the text, a caret and the suggestion as the remedy.
InputError error_in_filter(std::string const& option, std::string const& text, FilterProblem const&);

}  // namespace straytrace::results
