// SPDX-License-Identifier: BSD-3-Clause
#include "base/text/json_text.hpp"

#include <nlohmann/json.hpp>

namespace straytrace {

std::string json_text(nlohmann::json const& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_text(nlohmann::ordered_json const& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::json read_json(std::string_view text) { return nlohmann::json::parse(text); }

nlohmann::ordered_json read_ordered_json(std::string_view text) { return nlohmann::ordered_json::parse(text); }

}  // namespace straytrace
