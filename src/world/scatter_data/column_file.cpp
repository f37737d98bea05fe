// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "base/input/document.hpp"
#include "io/csv_cells.hpp"
#include "world/build/read_laws.hpp"
#include "world/scatter_data/text_tokens.hpp"

namespace straytrace {
namespace {

class ColumnsReader {
 public:
  ColumnsReader(std::string const& example, std::vector<Problem>& problems) : example_(example), problems_(problems) {}

  ColumnFile read(std::string_view text) {
    std::size_t const before = problems_.size();
    for (TextLine const& line : lines_of(text)) {
      if (problems_.size() - before >= 10 || (problems_.size() > before && file_.rows.empty() && !titled_)) break;
      titled_ ? row(line) : header(line);
    }
    bool const sound = problems_.size() == before;
    if (sound && file_.rows.empty())
      problem({}, "the file has no rows", fmt::format("write rows of numbers below the header '{}'", example_));
    if (!sound) file_.rows.clear();
    return file_;
  }

 private:
  void problem(Token const& where, std::string what, std::string suggestion) {
    complain(problems_, where, std::move(what), std::move(suggestion));
  }

  void header(TextLine const& line) {
    for (CsvCell const& cell : csv_cells(line.text)) {
      Token const where{cell.text, line.number, cell.column};
      auto const column = csv_name(cell.text);
      if (!column || is_number(column->name))
        return problem(where, fmt::format("cannot read the column name '{}'", shortened(cell.text)),
                       fmt::format("begin with a header such as '{}'", example_));
      std::string const name(column->name);
      if (file_.find(name) >= 0)
        return problem(where, fmt::format("column '{}' appears twice", name), "remove one of them");
      file_.columns.push_back({name, column->unit, line.number, cell.column});
    }
    titled_ = true;
  }

  void row(TextLine const& line) {
    auto const cells = csv_cells(line.text);
    if (std::size_t const at = line.text.find(';'); at != line.text.npos)
      return problem({line.text.substr(at, 1), line.number, std::uint32_t(at + 1)}, "values are separated by ';'",
                     "separate values by commas, not semicolons, and write decimal points: 1.5, not 1,5");
    if (cells.size() != file_.columns.size())
      return problem({line.text.substr(0, 1), line.number, 1},
                     fmt::format("{} values, but the header has {} columns", cells.size(), file_.columns.size()),
                     cells.size() > file_.columns.size() ? "use decimal points, not decimal commas: 1.5, not 1,5"
                                                         : "give one value per column, separated by commas");
    ColumnFile::Row row{{}, line.number, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      auto const value = csv_number(cells[i].text, file_.columns[i].unit);
      if (!value)
        return problem({cells[i].text, line.number, cells[i].column},
                       fmt::format("'{}' is not a number", shortened(cells[i].text)),
                       "write a finite number without unit; the unit stands in the header");
      row.values.push_back(*value);
      row.at.push_back(cells[i].column);
    }
    file_.rows.push_back(std::move(row));
  }

  std::string example_;
  std::vector<Problem>& problems_;
  ColumnFile file_;
  bool titled_ = false;
};

}  // namespace

int ColumnFile::find(std::string_view column) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == column) return int(i);
  return -1;
}

ColumnFile parse_columns(std::string_view text, std::string const& example, std::vector<Problem>& problems) {
  return ColumnsReader(example, problems).read(text);
}

ColumnFile read_columns(Node const& owner, std::string const& file, std::string const& example) {
  std::string const text = owner.data_file(file);
  if (text.empty()) return {};
  std::vector<Problem> problems;
  ColumnFile const out = parse_columns(text, example, problems);
  for (Problem const& p : problems) owner.file_problem(file, p.place.line, p.place.column, p.what, p.suggestion);
  return out;
}

}  // namespace straytrace
