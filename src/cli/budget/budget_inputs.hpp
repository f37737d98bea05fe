// SPDX-License-Identifier: BSD-3-Clause
// What straytrace budget reads.
#pragma once

#include "cli/budget/budget_view.hpp"

namespace straytrace {

struct BudgetRequest {
  std::vector<std::string> inputs, overrides, compare;
  std::string at = "10 Hz, 100 Hz, 1 kHz", band, margin;
  std::size_t points = 0;  // 0: those of the first run or budget, 300 without one
};
BudgetView gather_budget(BudgetRequest const&);  // throws InputError

std::vector<double> parse_frequencies(std::string const& list, char const* option);  // "10 Hz, 1 kHz"; InputError

}  // namespace straytrace
