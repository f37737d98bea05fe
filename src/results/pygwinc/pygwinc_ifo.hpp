// SPDX-License-Identifier: BSD-3-Clause
// Detectors from files in the layout of pygwinc's ifo.yaml, or by the name of a preset (docs/reference/budget.md).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "noise/fundamental/detector.hpp"

namespace straytrace::results {

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

}  // namespace straytrace::results
