// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "results/text/columns.hpp"

namespace straytrace::results {
namespace {

std::string shown(Sheet::Cell const& cell, Sheet::Column const& column) {
  if (auto const* text = std::get_if<std::string>(&cell)) return *text;
  double const value = std::get<double>(cell);
  return std::isnan(value) ? "-" : fmt::format("{:.{}g}", value * column.scale, column.digits);
}

std::string csv_cell(Sheet::Cell const& cell) {
  if (auto const* text = std::get_if<std::string>(&cell)) return csv_text(*text);
  double const value = std::get<double>(cell);
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

Columns shown_columns(Sheet const& s) {
  Columns table;
  for (Sheet::Column const& c : s.columns) {
    std::string const unit = c.shown.empty() ? c.unit : c.shown;
    table.titles.push_back(c.key + (unit.empty() ? "" : " [" + unit + "]"));
  }
  for (std::size_t i = 0; i < s.columns.size(); ++i)
    table.left.push_back(!s.rows.empty() && std::holds_alternative<std::string>(s.rows[0][i]));
  for (auto const& row : s.rows) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < row.size(); ++i) cells.push_back(shown(row[i], s.columns[i]));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

nlohmann::ordered_json page_of(std::vector<Sheet> const& sheets) {
  auto all = nlohmann::ordered_json::array();
  for (Sheet const& s : sheets) {
    Columns const table = shown_columns(s);
    all.push_back({{"name", s.name},
                   {"heading", s.heading},
                   {"titles", table.titles},
                   {"text", table.left},
                   {"rows", table.rows}});
  }
  return all;
}

std::string text_of(std::vector<Sheet> const& sheets) {
  std::string text;
  for (Sheet const& s : sheets) {
    Columns const table = shown_columns(s);
    text += (text.empty() ? "" : "\n") + s.heading + "\n" + (s.rows.empty() ? "" : "\n" + aligned(table));
  }
  return text;
}

std::string csv_of(std::vector<Sheet> const& sheets) {
  std::string text;
  for (Sheet const& s : sheets) {
    if (sheets.size() > 1) text += (text.empty() ? "# " : "\n# ") + s.name + "\n";
    for (std::size_t i = 0; i < s.columns.size(); ++i) {
      Sheet::Column const& c = s.columns[i];
      text += (i ? "," : "") + csv_text(c.key + (c.unit.empty() ? "" : " [" + c.unit + "]"));
    }
    text += "\n";
    for (auto const& row : s.rows) {
      for (std::size_t i = 0; i < row.size(); ++i) text += (i ? "," : "") + csv_cell(row[i]);
      text += "\n";
    }
  }
  return text;
}

nlohmann::ordered_json json_of(std::vector<Sheet> const& sheets) {
  nlohmann::ordered_json all;
  for (Sheet const& s : sheets) {
    nlohmann::ordered_json& rows = all[s.name] = nlohmann::ordered_json::array();
    for (auto const& row : s.rows) {
      nlohmann::ordered_json entry;
      for (std::size_t i = 0; i < row.size(); ++i) {
        auto const* text = std::get_if<std::string>(&row[i]);
        double const value = text ? 0 : std::get<double>(row[i]);
        if (text)
          entry[s.columns[i].key] = *text;
        else if (std::isfinite(value))
          entry[s.columns[i].key] = value;
        else
          entry[s.columns[i].key] = nullptr;
      }
      rows.push_back(std::move(entry));
    }
    nlohmann::ordered_json& units = all["units"][s.name];
    for (Sheet::Column const& c : s.columns)
      if (!c.unit.empty()) units[c.key] = c.unit;
  }
  return all;
}

}  // namespace straytrace::results
