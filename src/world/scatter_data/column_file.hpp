// SPDX-License-Identifier: BSD-3-Clause
// A text file of columns: header 'theta_i [deg], brdf [1/sr]', then rows; '#' starts a comment.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/units/quantity.hpp"

namespace straytrace {

struct ColumnFile {
  struct Column {
    std::string name;
    Quantity unit;
    std::uint32_t line, at;  // place of the name
  };
  struct Row {
    std::vector<double> values;  // SI
    std::uint32_t line;
    std::vector<std::uint32_t> at;  // columns where the cells begin
  };
  std::vector<Column> columns;
  std::vector<Row> rows;
  int find(std::string_view column) const;  // -1: none
};
// Without rows when there are problems, of which the first ten are said. `example`: a header for messages.
ColumnFile parse_columns(std::string_view text, std::string const& example, std::vector<Problem>&);

}  // namespace straytrace
