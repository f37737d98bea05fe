// SPDX-License-Identifier: BSD-3-Clause
// Columns of numbers in text: motion spectra, design curves.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace straytrace {

// Rows of numbers separated by blanks, tabs, commas or semicolons; '#' and '%' start comments. `error` says in words
// what was not understood and in which line; then there are no rows.
struct TextTable {
  std::vector<std::vector<double>> rows;
  std::string error;
};
TextTable parse_columns(std::string_view text);

// Two columns as functions of frequency, counted from 1. The frequency must increase; a first row at 0 Hz is dropped.
struct Curve {
  std::vector<double> hz, value;
  std::string error;
};
Curve parse_curve(std::string_view text, std::size_t frequency_column = 1, std::size_t value_column = 2);

}  // namespace straytrace
