// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/route_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "results/route_table/filter_parser.hpp"
#include "results/text/columns.hpp"

namespace straytrace {
namespace {

std::vector<std::string> words_in(std::string_view text) {
  std::istringstream in(lower_case(text));
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

// Conditions hold signs, brackets, quotes or one of these words.
bool is_condition(std::string_view text, std::vector<std::string> const& words) {
  return text.find_first_of("()<>=!\"'") != std::string_view::npos ||
         std::any_of(words.begin(), words.end(),
                     [](std::string const& w) { return w == "resolved" || w == "not" || w == "and" || w == "or"; });
}

// Plain words, looked for in route, body, port and kind.
bool has_words(std::vector<std::string> const& words, RouteColumns const& columns, std::size_t row) {
  std::vector<std::string> texts;
  for (char const* key : {"sequence", "body", "port", "kind"})
    texts.push_back(lower_case(columns.find(key)->texts[row]));
  return std::all_of(words.begin(), words.end(), [&](std::string const& w) {
    return std::any_of(texts.begin(), texts.end(), [&](auto const& text) { return text.find(w) != std::string::npos; });
  });
}

}  // namespace

FilterAnswer filtered(std::string_view text, RouteColumns& columns) {
  auto const words = words_in(text);
  ParsedFilter parsed;
  if (words.empty())
    parsed.test = [](std::size_t) { return true; };
  else if (!is_condition(text, words))
    parsed.test = [&](std::size_t i) { return has_words(words, columns, i); };
  else
    parsed = parse_filter(text, columns);
  FilterAnswer answer{{}, std::move(parsed.problems), std::move(parsed.notes)};
  for (std::size_t i = 0; answer.problems.empty() && i < columns.rows(); ++i)
    if (parsed.test(i)) answer.rows.push_back(i);
  return answer;
}

FilterAnswer sorted_by(std::string_view key, std::vector<std::size_t> rows, RouteColumns& columns) {
  ParsedFilter const parsed = parse_column(key, columns);
  if (!parsed.problems.empty()) return {{}, parsed.problems, {}};
  RouteColumn const& c = *parsed.column;
  auto const before = [&](std::size_t a, std::size_t b) {
    if (c.is_text) return c.texts[a] < c.texts[b];
    double const x = c.numbers[a], y = c.numbers[b];
    if (std::isnan(x) || std::isnan(y)) return !std::isnan(x) && std::isnan(y);
    return c.key == "rank" ? x < y : x > y;
  };
  std::stable_sort(rows.begin(), rows.end(), before);
  return {std::move(rows), {}, {}};
}

InputError error_in_filter(std::string const& option, std::string const& text, FilterProblem const& p) {
  std::size_t const column = width_of(text.substr(0, p.begin));
  std::size_t const wide = std::max<std::size_t>(1, width_of(text.substr(std::min(p.begin, text.size()), p.width)));
  return InputError(fmt::format("{}, column {}: {}", option, column + 1, p.what),
                    fmt::format("{}\n  {}{} {}", text, std::string(column, ' '), std::string(wide, '^'), p.suggestion));
}

}  // namespace straytrace
