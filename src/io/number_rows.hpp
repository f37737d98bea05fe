// SPDX-License-Identifier: BSD-3-Clause
// Rows of numbers in text: spectra, responses, shapes of modes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/table.hpp"

namespace straytrace {

// Numbers between blanks, tabs, commas or semicolons; '#' and '%' start comments; lines without numbers are left out.
// All rows have the same number of columns.
struct NumberRows {
  std::vector<std::vector<double>> rows;
  std::vector<std::uint32_t> line;  // of each row, from 1
  // What was not understood and where: code points from 1, line 0 for the text as a whole. Then there are no rows.
  std::string error;
  std::uint32_t error_line = 0, error_column = 0;

  std::string described_error() const;  // "line 2: 'five' is not a number"
};

enum class NonFinite : bool { refused, kept };  // words such as nan and inf
NumberRows parse_rows(std::string_view text, NonFinite = NonFinite::refused);

// Appends the numbers of one line; the word that is not one, as a part of `line`, or nothing.
std::string_view read_row(std::string_view line, std::vector<double>& row, NonFinite);
// "0,5 1,2", "10,5;1e-9": a comma between digits in a line of numbers that something else separates. "0,5, 1" is not
// meant: there commas separate.
bool has_decimal_commas(std::string_view line);
std::string_view without_byte_order_mark(std::string_view text);

// The data file that `file` names, with `columns` in each row (0: any number). Nothing, and a problem at its line, when
// it is not such a file; `remedy` says what to write there.
std::optional<NumberRows> read_number_rows(Node const& file, std::size_t columns, std::string const& remedy);

}  // namespace straytrace
