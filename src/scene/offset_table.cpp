// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/csv_cells.hpp"
#include "base/number_rows.hpp"
#include "scene/repeat.hpp"

namespace straytrace {
namespace {

class OffsetTable {
 public:
  explicit OffsetTable(Node const& name) : name_(name) {}

  Repeat read() {
    table_.offsets.clear();
    if (name_.kind() != Node::Kind::scalar) {
      if (name_) name_.problem("'table' takes the name of a file", "write 'table: baffles.csv'");
      return table_;
    }
    std::string const text = name_.data_file(name_.text());
    std::string_view rest = text;
    rest = without_byte_order_mark(rest);
    for (std::uint32_t number = 1; !rest.empty() && healthy_; ++number) {
      std::size_t const end = std::min(rest.find('\n'), rest.size());
      std::string_view const line = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (without_blanks(line).empty() || without_blanks(line).front() == '#') continue;
      if (units_.empty())
        header(line, number);
      else
        row(line, number);
    }
    if (healthy_ && table_.offsets.empty() && !text.empty())
      problem(0, 0, "the table has no rows", "write one row per instance below the header 'z [m], aperture [cm]'");
    if (!healthy_) table_.offsets.clear();
    return table_;
  }

 private:
  void problem(std::uint32_t line, std::uint32_t column, std::string what, std::string suggestion) {
    healthy_ = false;
    name_.file_problem(name_.text(), line, column, std::move(what), std::move(suggestion));
  }

  void header(std::string_view line, std::uint32_t number) {
    if (line.find(';') != std::string_view::npos)
      return problem(number, code_points(line.substr(0, line.find(';'))) + 1, "columns are separated by ';'",
                     "separate columns by commas and write decimal points");
    for (CsvCell const& cell : csv_cells(line)) {
      auto const column = csv_name(cell.text);
      if (!column)
        return problem(number, cell.column, fmt::format("cannot read the column name '{}'", shortened(cell.text)),
                       "write name and unit, for example 'z [m]'");
      std::string const name(column->name);
      std::size_t const axis = std::string_view("xyz").find(name);
      bool const position = name.size() == 1 && axis != std::string_view::npos;
      if (position && table_.axis >= 0)
        return problem(number, cell.column, "a second position column",
                       "keep one of x, y, z; instances stand along one axis");
      if (position && column->unit.dimension != dim::length)
        return problem(number, cell.column, fmt::format("column '{}' is a length and needs its unit", name),
                       fmt::format("write '{} [m]'", name));
      for (RepeatColumn const& other : table_.columns)
        if (other.name == name)
          return problem(number, cell.column, fmt::format("column '{}' appears twice", name), "remove one of them");
      if (position) table_.axis = static_cast<int>(axis);
      if (!position) table_.columns.push_back({name, column->unit.dimension, number, cell.column});
      is_position_.push_back(position);
      units_.push_back(column->unit);
    }
    if (table_.axis < 0) problem(number, 1, "no position column", "name one column 'x [m]', 'y [m]' or 'z [m]'");
  }

  void row(std::string_view line, std::uint32_t number) {
    auto const cells = csv_cells(line);
    if (cells.size() != units_.size())
      return problem(number, 1, fmt::format("{} values, but the header has {} columns", cells.size(), units_.size()),
                     cells.size() > units_.size() ? "use decimal points, not decimal commas: 1.5, not 1,5"
                                                  : "give one value per column");
    if (table_.offsets.size() >= most_instances)
      return problem(number, 1, fmt::format("more than {} rows", most_instances), "split the table");
    std::vector<Value> values;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      auto const si = csv_number(cells[i].text, units_[i]);
      if (!si) {
        bool const comma = cells[i].text.find_first_of("\";") != std::string_view::npos;
        return problem(number, cells[i].column, fmt::format("'{}' is not a number", shortened(cells[i].text)),
                       comma ? "use decimal points, not decimal commas: 1.5, not 1,5"
                             : "write a number without unit; the unit stands in the header");
      }
      if (is_position_[i])
        table_.offsets.push_back(*si);
      else
        values.push_back({{*si, units_[i].dimension, {}}, false});
    }
    table_.rows.push_back(std::move(values));
  }

  Node name_;
  Repeat table_;
  std::vector<Quantity> units_;
  std::vector<bool> is_position_;
  bool healthy_ = true;
};

}  // namespace

Repeat read_offset_table(Node const& name) { return OffsetTable(name).read(); }

}  // namespace straytrace
