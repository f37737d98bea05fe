// SPDX-License-Identifier: BSD-3-Clause
// Lines of comma-separated text: cells with their places, names with units, numbers.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/units/quantity.hpp"

namespace straytrace {

// What stands between two commas, without the blanks around it.
struct CsvCell {
  std::string_view text;
  std::uint32_t column = 1;  // code points, from 1
};
std::vector<CsvCell> csv_cells(std::string_view line);
// Without spaces, tabs and carriage returns at either end.
std::string_view without_blanks(std::string_view);

// "z [m]": name and unit, plain 1 where none is written. Nothing where there is no name or the unit is not one.
struct CsvName {
  std::string_view name;
  Quantity unit{1, dim::plain, {}};
};
std::optional<CsvName> csv_name(std::string_view cell);

// A number in `unit`, in SI; nothing where the cell is not a number.
std::optional<double> csv_number(std::string_view cell, Quantity const& unit);

}  // namespace straytrace
