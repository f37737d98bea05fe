// SPDX-License-Identifier: BSD-3-Clause
#include "io/csv_cells.hpp"

#include <algorithm>
#include <charconv>

#include "base/input/document.hpp"

namespace straytrace {

std::string_view without_blanks(std::string_view s) {
  auto const first = s.find_first_not_of(" \t\r");
  return first == s.npos ? std::string_view() : s.substr(first, s.find_last_not_of(" \t\r") + 1 - first);
}

std::vector<CsvCell> csv_cells(std::string_view line) {
  std::vector<CsvCell> cells;
  std::size_t counted = 0;  // bytes, of which the code points are known
  std::uint32_t points = 0;
  for (std::size_t begin = 0;;) {
    std::size_t const comma = std::min(line.find(',', begin), line.size());
    std::string_view const raw = line.substr(begin, comma - begin), text = without_blanks(raw);
    std::size_t const start = text.empty() ? begin : begin + std::size_t(text.data() - raw.data());
    points += code_points(line.substr(counted, start - counted));
    counted = start;
    cells.push_back({text, points + 1});
    if (comma == line.size()) return cells;
    begin = comma + 1;
  }
}

std::optional<CsvName> csv_name(std::string_view cell) {
  std::size_t const open = cell.find('[');
  CsvName out{without_blanks(cell.substr(0, open))};
  if (out.name.empty()) return {};
  if (open == cell.npos) return out;
  std::string_view const inside = cell.substr(open + 1);
  auto const unit =
      inside.ends_with(']') ? parse_unit(without_blanks(inside.substr(0, inside.size() - 1))) : std::nullopt;
  if (!unit) return {};
  out.unit = *unit;
  return out;
}

std::optional<double> csv_number(std::string_view cell, Quantity const& unit) {
  if (!is_number(cell)) return {};
  cell.remove_prefix(cell.front() == '+' ? 1 : 0);
  double value = 0;
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return to_si(value, unit);
}

}  // namespace straytrace
