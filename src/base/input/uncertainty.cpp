// SPDX-License-Identifier: BSD-3-Clause
#include "base/input/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/input/document.hpp"

namespace straytrace {
namespace {

constexpr double largest_factor = 1e6;
constexpr char const* factor_example = "write 'factor 1.5': from 1/1.5 to 1.5 times";

double read_factor(Node const& value, std::string_view text, double fallback) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  if (!is_number(text)) {
    value.problem(fmt::format("'factor' needs a plain number, got \"{}\"", shortened(text)), factor_example);
    return fallback;
  }
  double const factor = std::stod(std::string(text));
  if (factor >= 1 && factor <= largest_factor) return factor;
  value.problem(factor < 1 ? "a factor of uncertainty is at least 1"
                           : fmt::format("a factor of uncertainty is at most {:g}", largest_factor),
                factor_example);
  return fallback;
}

}  // namespace

double read_uncertainty(Node const& value, double fallback) {
  if (!value) return fallback;
  constexpr std::string_view word = "factor";
  std::string_view const text = value.text();
  if (text.starts_with(word) && (text.size() == word.size() || text[word.size()] == ' '))
    return read_factor(value, text.substr(word.size()), fallback);
  double const share = value.as_number(dim::plain, 0);
  if (share <= 1) return 1 + share;
  if (share > 1)
    value.problem(fmt::format("an uncertainty is at most 100 %, or a factor; got \"{}\"", shortened(text)),
                  is_number(text) ? fmt::format("did you mean '{0} %' or 'factor {0}'?", text)
                                  : fmt::format("write 'factor {:g}'", 1 + share));
  return fallback;
}

std::string read_status(Node const& table) {
  static constexpr std::string_view all[] = {"measured", "published", "required", "derived", "estimate", "assumed"};
  return table.has("status") ? table.choice("status", all) : std::string();
}

}  // namespace straytrace
