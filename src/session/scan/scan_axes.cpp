// SPDX-License-Identifier: BSD-3-Clause
#include "session/scan/scan_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/text/bounded_regex.hpp"
#include "base/text/words.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t most_points = 10000;

struct Number {
  double value = not_a_number;
  std::string unit;
};

Number number_in(std::string const& written) {
  std::string const text = with_plain_spaces(written);
  static std::regex const form(R"(\s*([+-]?[0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*)");
  std::smatch m;
  if (!bounded_regex_match(text, m, form)) return {};
  auto const number = leading_number(m[1].str());
  return {number ? number->value : infinity, m[2]};  // inf: beyond double
}

std::string written(double value, std::string const& unit) {
  return unit.empty() ? fmt::format("{:.12g}", value) : fmt::format("{:.12g} {}", value, unit);
}

// With the decimal commas of a range as points.
std::string pointed(std::string text) {
  static std::regex const comma("([0-9]),([0-9])");
  return text.size() > longest_match ? text : std::regex_replace(text, comma, "$1.$2");
}

std::string example(std::string const& name) {
  return fmt::format("write {0}=50cm..80cm:7, {0}=50cm..80cm:7:log or {0}=50cm,60cm,80cm", name);
}

[[noreturn]] void refuse_range(std::string const& word, std::string const& why, std::string const& name) {
  throw InputError(fmt::format("'{}': {}", word, why), example(name));
}

void add_range(ScanAxis& axis, std::string const& word, std::smatch const& m, bool open) {
  if (std::string const meant = pointed(word); meant != word)
    throw InputError(fmt::format("'{}' has a decimal comma", word), fmt::format("write '{}'", meant));
  Number const low = number_in(m[1]), high = number_in(m[2]);
  if (std::size_t const colon = high.unit.find(':'); colon != high.unit.npos)
    refuse_range(word, fmt::format("'{}' is not a number of values, with or without ':log'", high.unit.substr(colon)),
                 axis.name);
  if (!std::isfinite(low.value) || !std::isfinite(high.value))
    refuse_range(word, "a range runs from a number to a number", axis.name);
  if (low.unit != high.unit) refuse_range(word, "both ends of a range must have the same unit", axis.name);
  std::string const count = m[3];
  bool const logarithmic = m[4].matched;
  if (count.empty() && !open) refuse_range(word, "the range has no number of values", axis.name);
  double const n = count.empty() ? 2 : std::strtod(count.c_str(), nullptr);
  if (n < 2 || n > double(most_points))
    refuse_range(word, fmt::format("a range has 2 to {} values", most_points), axis.name);
  if (logarithmic && !(low.value > 0 && high.value > 0))
    refuse_range(word, "logarithmic steps need values above 0", axis.name);
  if (low.value == high.value) refuse_range(word, "the range has no width", axis.name);
  axis.unit = low.unit;
  axis.range = true;
  for (int i = 0; i < int(n); ++i) {
    double const share = i / (n - 1);
    double const value = logarithmic ? low.value * std::pow(high.value / low.value, share)
                                     : low.value + share * (high.value - low.value);
    axis.numbers.push_back(value);
    axis.values.push_back(written(value, axis.unit));
  }
}

void add_list(ScanAxis& axis, std::string const& word, std::string const& text) {
  for (std::size_t at = 0; at <= text.size();) {
    std::size_t const comma = std::min(text.find(',', at), text.size());
    std::string const value = text.substr(at, comma - at);
    if (value.find_first_not_of(' ') == value.npos) refuse_range(word, "a value is missing", axis.name);
    Number const number = number_in(value);
    if (axis.values.empty()) axis.unit = number.unit;
    axis.numbers.push_back(number.unit == axis.unit ? number.value : not_a_number);
    axis.values.push_back(value);
    at = comma + 1;
  }
}

ScanAxis parse_axis(std::string const& word, bool open) {
  static std::regex const range(R"(\s*(.+?)\s*\.\.\s*(.+?)\s*(?::([0-9]+)(:log)?)?\s*)");
  std::size_t const equal = word.find('=');
  if (equal == 0 || equal == word.npos)
    throw InputError(fmt::format("'{}' does not name a parameter and its values", word), example("name"));
  ScanAxis axis{word.substr(0, equal), {}, {}, "", false};
  std::string const text = word.substr(equal + 1);
  std::smatch m;
  if (bounded_regex_match(text, m, range))
    add_range(axis, word, m, open);
  else
    add_list(axis, word, text);
  return axis;
}

}  // namespace

std::vector<ScanAxis> parse_axes(std::vector<std::string> const& words, bool open) {
  std::vector<ScanAxis> axes;
  std::vector<InputError> errors;
  std::set<std::string> names;
  double points = 1;
  for (std::string const& word : words) try {
      axes.push_back(parse_axis(word, open));
      points *= double(axes.back().values.size());
      if (!names.insert(axes.back().name).second)
        throw InputError(fmt::format("'{}' is given twice", axes.back().name), "write all its values in one list");
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  throw_all(errors);
  if (points > double(most_points))
    throw InputError(fmt::format("{:.0f} combinations are more than {}", points, most_points), "use fewer values");
  return axes;
}

std::vector<std::vector<std::string>> combinations(std::vector<ScanAxis> const& axes) {
  std::vector<std::vector<std::string>> all{{}};
  for (ScanAxis const& axis : axes) {
    std::vector<std::vector<std::string>> next;
    for (auto const& before : all)
      for (std::string const& value : axis.values) {
        next.push_back(before);
        next.back().push_back(axis.name + "=" + value);
      }
    all = std::move(next);
  }
  return all;
}

}  // namespace straytrace::session
