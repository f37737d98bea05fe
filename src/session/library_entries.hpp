// SPDX-License-Identifier: BSD-3-Clause
// The content of the library of the program, one line for each entry.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::session {

struct LibraryEntry {
  std::string kind;  // material, medium, part, detector, arm
  std::string name;
  std::string file;   // what to include; empty: known without
  std::string value;  // numbers in brief, low / mid / high where they have a bracket
  std::string wavelength, status, source, note;
  std::string text;                                               // as written
  std::vector<std::pair<std::string, std::string>> numbers = {};  // of parts and detectors: parameter, default
};

std::vector<LibraryEntry> library_entries();  // by kind, then as the files have them

}  // namespace straytrace::session
