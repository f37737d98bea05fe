// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/words.hpp"
#include "results/text/table.hpp"

namespace straytrace {
namespace {

std::string line_of(std::vector<std::string> const& cells, std::vector<std::size_t> const& widths,
                    std::vector<bool> const& left, std::string const& indent) {
  std::string line = indent;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string const gap(widths[i] - width_of(cells[i]), ' ');
    bool const to_left = i < left.size() && left[i];
    line += (i > 0 ? "  " : "") + (to_left ? cells[i] + gap : gap + cells[i]);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

std::size_t width_of(std::string const& utf8) {
  return std::size_t(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string aligned(Columns const& columns, std::string const& indent) {
  std::vector<std::size_t> widths;
  for (std::string const& title : columns.titles) widths.push_back(width_of(title));
  for (std::vector<std::string> const& row : columns.rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  std::size_t total = 2 * (widths.size() - 1);
  for (std::size_t const w : widths) total += w;
  std::string const rule = indent + std::string(total, '-') + "\n";
  std::string text = line_of(columns.titles, widths, columns.left, indent) + rule;
  for (std::vector<std::string> const& row : columns.rows)
    text += row.empty() ? rule : line_of(row, widths, columns.left, indent);
  return printable(text);  // names come from files of others
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string csv_text(std::string const& text) {
  std::string quoted = "\"";
  for (char const c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text.find_first_of(",\"\n") == std::string::npos ? text : quoted + "\"";
}

std::string csv_number(bool known, double value) {
  return known && !std::isnan(value) ? fmt::format("{}", value) : "nan";
}

std::string finite_text(double x, std::string const& format) {
  return std::isfinite(x) ? fmt::format(fmt::runtime(format), x) : "-";
}

// Cells of tables.

std::string_view name_of(ColumnKind kind) {
  constexpr std::string_view names[] = {"text", "flag", "count", "number", "estimate", "list"};
  return names[std::size_t(kind)];
}

std::string cell_text(TableCell const& cell, std::string const& format) {
  if (auto const* const text = std::get_if<std::string>(&cell)) return text->empty() ? "-" : *text;
  if (auto const* const yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (auto const* const count = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *count);
  if (auto const* const x = std::get_if<WithError>(&cell)) return with_brackets(*x);
  return finite_text(std::get<double>(cell), format);
}

std::string cell_csv(TableCell const& cell, double scale) {
  if (auto const* const text = std::get_if<std::string>(&cell)) return csv_text(*text);
  if (auto const* const yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (auto const* const count = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *count);
  if (auto const* const x = std::get_if<WithError>(&cell))
    return csv_number(true, scale * x->value) + "," + csv_number(true, scale * x->sigma);
  return csv_number(true, scale * std::get<double>(cell));
}

nlohmann::ordered_json error_json(WithError const& x) {
  nlohmann::ordered_json j{{"value", x.value}, {"sigma", x.sigma}};
  if (x.at_most) j["at_most"] = true;
  return j;
}

nlohmann::ordered_json cell_json(TableCell const& cell, double scale) {
  if (auto const* const text = std::get_if<std::string>(&cell)) return *text;
  if (auto const* const yes = std::get_if<bool>(&cell)) return *yes;
  if (auto const* const count = std::get_if<std::uint64_t>(&cell)) return *count;
  if (auto const* const x = std::get_if<WithError>(&cell))
    return error_json({scale * x->value, scale * x->sigma, x->at_most});
  return scale * std::get<double>(cell);
}

}  // namespace straytrace
