// SPDX-License-Identifier: BSD-3-Clause
// Files of pygwinc: detectors from ifo.yaml or presets, and traces of budgets.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "noise/fundamental/fundamental.hpp"

namespace straytrace::results {

// Detectors from files in the layout of pygwinc's ifo.yaml, or by the name of a preset (docs/reference/budget.md).

// A noise given as a table of two columns, Hz and ASD. Named like a fundamental noise it replaces it.
struct CurveFile {
  std::string name, file;     // file: as it can be opened
  bool displacement = false;  // m/sqrt(Hz) of the difference of the arms, instead of strain
};

struct IfoFile {
  Detector detector;
  std::string title;              // name of the file or preset; empty: unnamed
  std::string compare;            // design curve that belongs to it; empty: none
  std::vector<CurveFile> curves;  // technical noises
  std::string yaml;               // all its values, in the form of pygwinc
};

std::vector<std::string> ifo_presets();
// A preset, or a YAML file. Unknown keys are accepted, unless the file has `extends: PRESET`: then it may only change
// or add known keys. Overrides: "Laser.Power=25", in SI. Throws InputError with all problems and missing
// values.
IfoFile read_ifo(std::string const& preset_or_file, std::vector<std::string> const& overrides = {});

// Noise budgets in the HDF5 layout of pygwinc (docs/reference/budget.md): version 2 is written, 1 and 2 are read.

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
