// SPDX-License-Identifier: BSD-3-Clause
// Answers of `straytrace explain`, each as text and as JSON. They throw InputError with a suggestion.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

#include "base/namespaces.hpp"

namespace straytrace::cli {

struct Explanation {
  std::string text;
  nlohmann::ordered_json json;
};

// "cone.half_angle", "half_angle" in all tables, "cone" with all its keys; empty without a similar name.
std::optional<Explanation> explain_key(std::string const& what);
std::string nearest_key(std::string const& what);  // empty: none
// An entry of the library, "virgo_baffle", or a number of a part or detector, "virgo_baffle.inner_radius".
std::optional<Explanation> explain_library(std::string const& what);
// Parts whose names hold the word before the dot, with their numbers, as a suggestion; empty: none.
std::string parts_like(std::string const& what);
// A column of the path table, "coupling".
std::optional<Explanation> explain_column(std::string const& what);
// A word that stands in tables in place of an error or a number, "at most".
std::optional<Explanation> explain_mark(std::string const& what);
Explanation explain_unit(std::string const& unit);
// A printed message or a part of it; empty without a similar one.
std::optional<Explanation> explain_message(std::string const& text);
// The chain of factors from the coupling of one route to its strain at `hz` (docs/theory/spectra.md and
// docs/theory/interferometer.md). `path`: its rank in the path table.
Explanation explain_strain(std::string const& run_file, std::size_t path, double hz);

}  // namespace straytrace::cli
