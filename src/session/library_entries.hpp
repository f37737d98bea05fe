// SPDX-License-Identifier: BSD-3-Clause
// What the program knows: entries of its library, and the tables and keys of its language.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::session {

// The content of the library of the program, one line for each entry.

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

// The language as its schema describes it: tables and keys by the names that `explain` takes.

struct LanguageKey {
  std::string table, about;  // "cone", "the shape cone"
  std::string key;
  nlohmann::ordered_json schema;  // of its value

  std::string text() const;  // meaning, in one sentence
  std::string fact(
      std::string const&) const;  // "type", "range", "default", "page", "example"; empty when there is none
};

// By table, then key. Tables of one name (a port of the scene, a port of the detector) have names of their own.
std::vector<LanguageKey> const& language_keys();
std::string_view language_schema();  // JSON

}  // namespace straytrace::session
