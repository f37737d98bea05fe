// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/files/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace straytrace {
namespace {

// Two columns of rows as a function of frequency.
Curve of_rows(NumberRows const& table, std::size_t frequency_column, std::size_t value_column) {
  Curve curve;
  std::size_t const columns = table.rows.front().size();
  if (frequency_column < 1 || value_column < 1 || std::max(frequency_column, value_column) > columns) {
    curve.error = fmt::format("it has {} columns, asked for {} and {}", columns, frequency_column, value_column);
    return curve;
  }
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    double const f = table.rows[i][frequency_column - 1], v = table.rows[i][value_column - 1];
    if (curve.hz.empty() && f == 0) continue;
    if (!(f > 0) || (!curve.hz.empty() && f <= curve.hz.back()))
      return {{}, {}, fmt::format("the frequency does not increase at {} Hz", f), table.line[i]};
    if (v < 0 || std::isinf(v))
      return {{}, {}, fmt::format("{} value at {} Hz", v < 0 ? "negative" : "infinite", f), table.line[i]};
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

std::string trimmed(std::string_view text) {
  auto const first = text.find_first_not_of(" \t\r\""), last = text.find_last_not_of(" \t\r\"");
  return first == text.npos ? "" : std::string(text.substr(first, last + 1 - first));
}

// Cells of a row of words: between commas, semicolons or tabs where there are any, otherwise between blanks, and
// "[um]" belongs to what stands before it.
std::vector<std::string> cells(std::string_view line) {
  bool const marked = line.find_first_of(",;\t") != line.npos;
  std::vector<std::string> found;
  std::string cell;
  int depth = 0;
  auto const finish = [&] {
    if (std::string const text = trimmed(cell); !text.empty() && !marked && text[0] == '[' && !found.empty())
      found.back() += " " + text;
    else if (marked || !text.empty())
      found.push_back(text);
    cell.clear();
  };
  for (char const c : line) {
    depth += (c == '[' || c == '(') - (c == ']' || c == ')');
    bool const end = marked ? c == ',' || c == ';' || c == '\t' : c == ' ' || c == '\r';
    if (end && depth <= 0)
      finish();
    else
      cell += c;
  }
  finish();
  return found;
}

// "x [um]" and "x (um)".
void name_column(std::string const& cell, NamedColumns& into) {
  for (auto const& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}})
    if (auto const begin = cell.find(open); begin != cell.npos && begin > 0 && cell.back() == close) {
      into.name.push_back(trimmed(cell.substr(0, begin)));
      into.unit.push_back(trimmed(cell.substr(begin + 1, cell.size() - begin - 2)));
      return;
    }
  into.name.push_back(cell);
  into.unit.emplace_back();
}

// What describes the columns: the row of words above the numbers, or the comments.
struct Headings {
  std::vector<std::string> row;
  std::vector<std::vector<std::string>> comments;

  // The comment that names units goes before one that does not, a later before an earlier.
  std::vector<std::string> best(std::size_t columns) const {
    if (!row.empty()) return row;
    std::vector<std::string> found;
    bool with_units = false;
    for (auto const& cells : comments) {
      bool const units = std::any_of(cells.begin(), cells.end(), [](auto const& c) { return c.ends_with(']'); });
      if (cells.size() != columns || (with_units && !units)) continue;
      found = cells;
      with_units = units;
    }
    return found;
  }
};

void add_row(std::vector<double> const& row, std::size_t number, NamedColumns& into) {
  if (into.column.empty()) into.column.resize(row.size());
  if (row.size() != into.column.size()) {
    into.error =
        fmt::format("line {} has {} columns, the lines before have {}", number, row.size(), into.column.size());
    return;
  }
  for (std::size_t i = 0; i < row.size(); ++i) into.column[i].push_back(row[i]);
  into.line.push_back(number);
}

// Names and units once the numbers are known.
void name_all(Headings const& headings, NamedColumns& table) {
  std::vector<std::string> const titles = headings.best(table.column.size());
  if (!titles.empty() && titles.size() != table.column.size())
    table.error = fmt::format(
        "line {} has {} numbers, and the row of names has {} (numbers are written with a point, 0.5, not with a comma)",
        table.line.front(), table.column.size(), titles.size());
  else if (titles.empty())
    table.name.resize(table.column.size()), table.unit.resize(table.column.size());
  for (std::string const& title : table.error.empty() ? titles : std::vector<std::string>()) name_column(title, table);
}

}  // namespace

NamedColumns parse_named_columns(std::string_view text) {
  text = without_byte_order_mark(text);
  NamedColumns table;
  Headings headings;
  std::vector<double> row;
  for (std::size_t number = 1; !text.empty() && table.error.empty(); ++number) {
    auto const end = std::min(text.find('\n'), text.size());
    std::string_view const line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    row.clear();
    std::string_view const bad = read_row(line, row, NonFinite::kept);
    auto const start = line.find_first_not_of(" \t\r#%");
    if (start == line.npos) continue;
    bool const comment = line.substr(0, start).find_first_of("#%") != line.npos;
    if (comment && table.line.empty()) headings.comments.push_back(cells(line.substr(start)));
    if (comment) continue;
    if (has_decimal_commas(line))
      table.error = fmt::format("line {}: '{}' has decimal commas; write 0.5 instead of 0,5", number, trimmed(line));
    else if (!bad.empty() && row.empty() && table.line.empty() && headings.row.empty())
      headings.row = cells(line.substr(0, line.find('#')));
    else if (!bad.empty())
      table.error = fmt::format("line {}: '{}' is not a number (comments start with #)", number, bad);
    else if (!row.empty())
      add_row(row, number, table);
  }
  if (table.error.empty() && table.line.empty()) table.error = "no numbers in it";
  if (table.error.empty()) name_all(headings, table);
  return table;
}

Curve curve_of(NumberRows const& table, std::size_t frequency_column, std::size_t value_column) {
  if (table.error.empty()) return of_rows(table, frequency_column, value_column);
  return {{}, {}, table.described_error()};
}

Curve parse_curve(std::string_view text, std::size_t frequency_column, std::size_t value_column) {
  return curve_of(parse_rows(text), frequency_column, value_column);
}

Curve parse_named_curve(std::string_view text, std::span<std::string_view const> names) {
  text = without_byte_order_mark(text);
  NumberRows const table = parse_rows(text, NonFinite::kept);
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
