// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "base/csv_cells.hpp"
#include "base/document.hpp"
#include "base/number_rows.hpp"
#include "world/read_laws.hpp"

namespace straytrace {
namespace {

class Reader {
 public:
  Reader(Node const& owner, std::string const& file, std::string const& example) : owner_(owner), example_(example) {
    file_.name = file;
  }

  ColumnFile read() {
    std::string const text = owner_.data_file(file_.name);
    std::string_view rest = text;
    rest = without_byte_order_mark(rest);
    for (std::uint32_t number = 1; !rest.empty() && healthy_; ++number) {
      std::size_t const end = std::min(rest.find('\n'), rest.size());
      std::string_view const line = rest.substr(0, std::min(end, rest.find('#')));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (without_blanks(line).empty()) continue;
      file_.columns.empty() ? header(line, number) : row(line, number);
    }
    if (healthy_ && file_.rows.empty() && !text.empty())
      problem(0, 0, "the file has no rows", fmt::format("write rows of numbers below the header '{}'", example_));
    if (!healthy_) file_.rows.clear();
    return file_;
  }

 private:
  void problem(std::uint32_t line, std::uint32_t at, std::string what, std::string suggestion) {
    healthy_ = false;
    owner_.file_problem(file_.name, line, at, std::move(what), std::move(suggestion));
  }

  void header(std::string_view line, std::uint32_t number) {
    for (CsvCell const& cell : csv_cells(line)) {
      auto const column = csv_name(cell.text);
      if (!column || is_number(column->name))
        return problem(number, cell.column, fmt::format("cannot read the column name '{}'", shortened(cell.text)),
                       fmt::format("begin with a header such as '{}'", example_));
      std::string const name(column->name);
      if (file_.find(name) >= 0)
        return problem(number, cell.column, fmt::format("column '{}' appears twice", name), "remove one of them");
      file_.columns.push_back({name, column->unit, number, cell.column});
    }
  }

  void row(std::string_view line, std::uint32_t number) {
    auto const cells = csv_cells(line);
    if (cells.size() != file_.columns.size())
      return problem(number, 1,
                     fmt::format("{} values, but the header has {} columns", cells.size(), file_.columns.size()),
                     cells.size() > file_.columns.size() ? "use decimal points, not decimal commas: 1.5, not 1,5"
                                                         : "give one value per column, separated by commas");
    ColumnFile::Row row{{}, number, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      auto const value = csv_number(cells[i].text, file_.columns[i].unit);
      if (!value)
        return problem(number, cells[i].column, fmt::format("'{}' is not a number", shortened(cells[i].text)),
                       "write a number without unit; the unit stands in the header");
      row.values.push_back(*value);
      row.at.push_back(cells[i].column);
    }
    file_.rows.push_back(std::move(row));
  }

  Node owner_;
  std::string example_;
  ColumnFile file_;
  bool healthy_ = true;
};

}  // namespace

int ColumnFile::find(std::string_view column) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == column) return int(i);
  return -1;
}

ColumnFile read_columns(Node const& owner, std::string const& file, std::string const& example) {
  return Reader(owner, file, example).read();
}

}  // namespace straytrace
