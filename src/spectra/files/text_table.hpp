// SPDX-License-Identifier: BSD-3-Clause
// Columns of numbers in text: motion spectra, design curves.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/number_rows.hpp"

namespace straytrace {

// Columns with what the file says about them: in a first row of words (CSV), or in a comment above the numbers that has
// one name for each column; "x [um]" and "x (um)" name a unit. NaN stays NaN: a caller knows where it is allowed.
struct NamedColumns {
  std::vector<std::string> name, unit;  // one for each column; empty where none is given
  std::vector<std::vector<double>> column;
  std::vector<std::size_t> line;  // of the file, one for each row
  std::string error;              // with its line; decimal commas are told apart and named
};
NamedColumns parse_named_columns(std::string_view text);

// Two columns as functions of frequency, counted from 1. The frequency must increase; a first row at 0 Hz is dropped.
struct Curve {
  std::vector<double> hz, value;
  std::string error;
  std::uint32_t error_line = 0;  // of a row whose numbers do not fit, which `error` does not name
};
Curve curve_of(NumberRows const&, std::size_t frequency_column = 1, std::size_t value_column = 2);
Curve parse_curve(std::string_view text, std::size_t frequency_column = 1, std::size_t value_column = 2);

// Columns of our own text files that hold an ASD of strain: of budget.txt and of h_asd.txt.
constexpr std::string_view strain_columns[] = {"total_strain", "h_mean"};
// Two columns; of more, the one that a comment above the numbers gives one of these names, where NaN is "not known". An
// error, with the columns that are there, when none has such a name.
Curve parse_named_curve(std::string_view text, std::span<std::string_view const> names);

}  // namespace straytrace
