// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/columns.hpp"

#include <algorithm>

#include "base/text/words.hpp"

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

}  // namespace straytrace
