// SPDX-License-Identifier: BSD-3-Clause
// A noise budget from detectors, run files and budgets of pygwinc, as text, columns, JSON and HDF5.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

#include "noise/fundamental/budget.hpp"
#include "noise/noise.hpp"
#include "results/budget/budget_sources.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"

namespace straytrace::results {

// A budget on one set of frequencies.
struct BudgetOn {
  NoiseTable table;
  std::vector<DesignCurve> curves;  // ratios refer to the first one
  std::vector<DesignCurve> lines;   // curves that are not separate noises: shot noise alone, quantum limit, requirement
  std::vector<double> metres;       // change of the difference of the arms per strain; empty without a detector
};

struct BudgetView {
  std::string title, version, commit;  // of the program
  std::vector<std::string> inputs;
  std::optional<IfoFile> ifo;
  std::string detector;  // as it was named
  std::vector<RunAbout> runs;
  std::vector<std::string> models;  // hashes of the scenes whose stray light is in it
  BudgetOn grid, at;                // for curves and pictures; for the table
  double margin = 0.1;
  std::vector<std::string> left_out, warnings;
};

std::string budget_text(BudgetView const&);     // as text
std::string budget_columns(BudgetView const&);  // text file with one column per noise
nlohmann::ordered_json budget_json(BudgetView const&);
std::string budget_pygwinc(BudgetView const&);  // bytes of an HDF5 file

struct BudgetRequest {
  std::vector<std::string> inputs, overrides, compare;
  std::vector<double> at, band;  // Hz; `band`: its two ends, or empty
  double margin = 0.1;
  std::size_t points = 0;  // 0: those of the first run or budget, 300 without one
};
BudgetView gather_budget(BudgetRequest const&);  // throws InputError

}  // namespace straytrace::results
