// SPDX-License-Identifier: BSD-3-Clause
// Noise budgets in the HDF5 layout of pygwinc (docs/reference/budget.md): version 2 is written, 1 and 2 are read.
#pragma once

#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::results {

// A noise with its parts.
struct BudgetTrace {
  std::string name, label;  // name: of the group; label: for pictures
  std::vector<double> psd;  // strain^2/Hz
  std::vector<BudgetTrace> parts;
};

struct BudgetFile {
  std::vector<double> hz;
  BudgetTrace total;
  std::string ifo;                    // YAML text of the detector; empty: none
  std::vector<std::string> models{};  // hashes of the scenes whose stray light is in it; empty: not stated
};

bool is_hdf5(std::string const& bytes);  // by its first bytes
// An HDF5 file that is not a run. Throws InputError with the name when it is damaged.
bool is_budget_file(std::string const& bytes, std::string const& name);
// Throws InputError with the place in the file that is missing or damaged.
BudgetFile read_budget_file(std::string const& file);
// `about`: further attributes of the root, in pairs of name and value. Names must not hold '/'.
std::string budget_file_bytes(BudgetFile const&, std::vector<std::pair<std::string, std::string>> const& about);

}  // namespace straytrace::results
