// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <regex>

#include "app/model.hpp"
#include "base/message.hpp"

namespace straytrace {
namespace {

double seconds_in(std::string const& unit) { return unit == "h" ? 3600 : unit == "min" ? 60 : 1; }

void parse_one(std::string const& text, StopRule& rule) {
  static std::regex const by_error(R"(\s*(h_total|routes)\s*<\s*([0-9.eE+-]+)\s*(%?)\s*)");
  static std::regex const by_time(R"(\s*([0-9.eE+-]+)\s*(s|min|h)\s*)");
  std::smatch m;
  try {
    if (std::regex_match(text, m, by_error)) {
      rule.of = m[1] == "routes" ? StopRule::Of::routes : StopRule::Of::total;
      rule.relative_error = std::stod(m[2]) * (m[3].length() ? 0.01 : 1);
      rule.error_rule = fmt::format("{} < {:g}", m[1].str(), rule.relative_error);
      if (rule.relative_error > 0 && rule.relative_error < 1) return;
    } else if (std::regex_match(text, m, by_time)) {
      rule.max_seconds = std::stod(m[1]) * seconds_in(m[2]);
      if (rule.max_seconds > 0) return;
    }
  } catch (std::exception const&) {  // not a number: fall through to the message
  }
  throw InputError(fmt::format("'{}' is not a stop rule; write 'h_total < 5 %', 'routes < 10 %' or '10 min'", text));
}

}  // namespace

double parse_duration(std::string const& text) {
  static std::regex const duration(R"(\s*([0-9]+\.?[0-9]*(?:[eE][+-]?[0-9]+)?)\s*(s|min|h|)\s*)");
  std::smatch m;
  double const seconds = std::regex_match(text, m, duration) ? std::stod(m[1]) * seconds_in(m[2]) : 0;
  if (!(seconds > 0))
    throw InputError(fmt::format("error: '{}' is not a time\n  write for example 90s, 50min or 1h", text));
  return seconds;
}

StopRule parse_stop_rule(std::string const& text) {
  StopRule rule;
  for (std::size_t at = 0; at <= text.size();) {
    std::size_t const comma = std::min(text.find(',', at), text.size());
    parse_one(text.substr(at, comma - at), rule);
    at = comma + 1;
  }
  return rule;
}

}  // namespace straytrace
