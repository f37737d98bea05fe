// SPDX-License-Identifier: BSD-3-Clause
// JSON as text and back, compiled once: parser and writer take seconds in every file that uses them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {

// With `indent`, on several lines. Bytes that are not UTF-8 become U+FFFD.
std::string json_text(nlohmann::json const&, int indent = -1);
std::string json_text(nlohmann::ordered_json const&, int indent = -1);

// Throws nlohmann::json::parse_error.
nlohmann::json read_json(std::string_view text);
nlohmann::ordered_json read_ordered_json(std::string_view text);

}  // namespace straytrace
