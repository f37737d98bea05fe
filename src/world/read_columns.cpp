// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <charconv>

#include "base/document.hpp"
#include "world/read_laws.hpp"

namespace straytrace {
namespace {

struct Cell {
  std::string_view text;
  std::uint32_t at;  // code points, 1-based
};

std::string_view trimmed(std::string_view s) {
  auto const first = s.find_first_not_of(" \t\r");
  return first == s.npos ? std::string_view() : s.substr(first, s.find_last_not_of(" \t\r") + 1 - first);
}

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0;;) {
    std::size_t const comma = std::min(line.find(',', begin), line.size());
    std::string_view const raw = line.substr(begin, comma - begin), text = trimmed(raw);
    std::size_t const start = text.empty() ? begin : begin + std::size_t(text.data() - raw.data());
    cells.push_back({text, code_points(line.substr(0, start)) + 1});
    if (comma == line.size()) return cells;
    begin = comma + 1;
  }
}

class Reader {
 public:
  Reader(Node const& owner, std::string const& file, std::string const& example) : owner_(owner), example_(example) {
    file_.name = file;
  }

  ColumnFile read() {
    std::string const text = owner_.data_file(file_.name);
    std::string_view rest = text;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
    for (std::uint32_t number = 1; !rest.empty() && healthy_; ++number) {
      std::size_t const end = std::min(rest.find('\n'), rest.size());
      std::string_view const line = rest.substr(0, std::min(end, rest.find('#')));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (trimmed(line).empty()) continue;
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
    for (Cell const& cell : cells_of(line)) {
      std::size_t const open = cell.text.find('[');
      std::string const name(trimmed(cell.text.substr(0, open)));
      auto unit = std::optional(Quantity{1, dim::plain, {}});
      if (open != cell.text.npos)
        unit = cell.text.ends_with(']') ? parse_unit(trimmed(cell.text.substr(open + 1, cell.text.size() - open - 2)))
                                        : std::nullopt;
      if (name.empty() || is_number(name) || !unit)
        return problem(number, cell.at, fmt::format("cannot read the column name '{}'", shortened(cell.text)),
                       fmt::format("begin with a header such as '{}'", example_));
      if (file_.find(name) >= 0)
        return problem(number, cell.at, fmt::format("column '{}' appears twice", name), "remove one of them");
      file_.columns.push_back({name, *unit, number, cell.at});
    }
  }

  void row(std::string_view line, std::uint32_t number) {
    auto const cells = cells_of(line);
    if (cells.size() != file_.columns.size())
      return problem(number, 1,
                     fmt::format("{} values, but the header has {} columns", cells.size(), file_.columns.size()),
                     cells.size() > file_.columns.size() ? "use decimal points, not decimal commas: 1.5, not 1,5"
                                                         : "give one value per column, separated by commas");
    ColumnFile::Row row{{}, number, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!is_number(cells[i].text))
        return problem(number, cells[i].at, fmt::format("'{}' is not a number", shortened(cells[i].text)),
                       "write a number without unit; the unit stands in the header");
      std::string_view const digits = cells[i].text.substr(cells[i].text.front() == '+' ? 1 : 0);
      double value = 0;
      std::from_chars(digits.data(), digits.data() + digits.size(), value);
      row.values.push_back(to_si(value, file_.columns[i].unit));
      row.at.push_back(cells[i].at);
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
