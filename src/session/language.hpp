// SPDX-License-Identifier: BSD-3-Clause
// The language as its schema describes it: tables and keys by the names that `explain` takes.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::session {

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
