// SPDX-License-Identifier: BSD-3-Clause
#include "signal/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace straytrace {
namespace {

constexpr std::string_view separators = " \t,;\r";

enum class Unknown { refused, taken };  // words such as nan

// Appends the numbers of one line; what could not be read, or nothing.
std::string_view read_row(std::string_view line, std::vector<double>& row, Unknown unknown) {
  line = line.substr(0, line.find_first_of("#%"));
  while (true) {
    auto const start = line.find_first_not_of(separators);
    if (start == line.npos) return {};
    line.remove_prefix(start);
    std::string_view word = line.substr(0, line.find_first_of(separators));
    line.remove_prefix(word.size());
    std::string_view const digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    auto const [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (status != std::errc{} || end != digits.data() + digits.size()) return word;
    if (unknown == Unknown::refused && !std::isfinite(value)) return word;
    row.push_back(value);
  }
}

TextTable read_rows(std::string_view text, Unknown unknown) {
  TextTable table;
  for (std::size_t number = 1; !text.empty(); ++number) {
    auto const end = std::min(text.find('\n'), text.size());
    std::vector<double> row;
    std::string_view const bad = read_row(text.substr(0, end), row, unknown);
    if (!bad.empty()) return {{}, fmt::format("line {}: '{}' is not a number (comments start with #)", number, bad)};
    if (!row.empty() && !table.rows.empty() && row.size() != table.rows.front().size())
      return {{},
              fmt::format("line {} has {} columns, the lines before have {}", number, row.size(),
                          table.rows.front().size())};
    if (!row.empty()) table.rows.push_back(std::move(row));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (table.rows.empty()) table.error = "no numbers in it";
  return table;
}

Curve curve_of(TextTable const& table, std::size_t frequency_column, std::size_t value_column) {
  Curve curve;
  curve.error = table.error;
  if (!curve.error.empty()) return curve;
  std::size_t const columns = table.rows.front().size();
  if (frequency_column < 1 || value_column < 1 || std::max(frequency_column, value_column) > columns)
    return {{}, {}, fmt::format("it has {} columns, asked for {} and {}", columns, frequency_column, value_column)};
  for (auto const& row : table.rows) {
    double const f = row[frequency_column - 1], v = row[value_column - 1];
    if (curve.hz.empty() && f == 0) continue;
    if (!(f > 0) || (!curve.hz.empty() && f <= curve.hz.back()))
      return {{}, {}, fmt::format("the frequency does not increase at {} Hz", f)};
    if (v < 0 || std::isinf(v)) return {{}, {}, fmt::format("{} value at {} Hz", v < 0 ? "negative" : "infinite", f)};
    curve.hz.push_back(f);
    curve.value.push_back(v);
  }
  if (curve.hz.size() < 2) return {{}, {}, "fewer than two rows with a frequency above zero"};
  return curve;
}

// The words of the last comment above the numbers that has one for each column, or none.
std::vector<std::string> headings(std::string_view text, std::size_t columns) {
  std::vector<std::string> found;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line) && (line.empty() || line[0] == '#' || line[0] == '\r');) {
    std::istringstream words(line.substr(std::min<std::size_t>(1, line.size())));
    std::vector<std::string> all;
    for (std::string word; words >> word;) all.push_back(word);
    if (all.size() == columns) found = std::move(all);
  }
  return found;
}

}  // namespace

TextTable parse_columns(std::string_view text) { return read_rows(text, Unknown::refused); }

Curve parse_curve(std::string_view text, std::size_t frequency_column, std::size_t value_column) {
  return curve_of(parse_columns(text), frequency_column, value_column);
}

Curve parse_named_curve(std::string_view text, std::span<std::string_view const> names) {
  TextTable const table = read_rows(text, Unknown::taken);
  if (!table.error.empty() || table.rows.front().size() <= 2) return parse_curve(text);
  std::size_t const columns = table.rows.front().size();
  std::vector<std::string> const titles = headings(text, columns);
  for (std::string_view const name : names)
    for (std::size_t i = 1; i < titles.size(); ++i)
      if (titles[i] == name) return curve_of(table, 1, i + 1);
  std::string const there = titles.empty() ? "without names" : fmt::format("({})", fmt::join(titles, ", "));
  return {{}, {}, fmt::format("it has {} columns {}, and none is named {}", columns, there, fmt::join(names, " or "))};
}

}  // namespace straytrace
