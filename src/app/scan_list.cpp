// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "app/common_options.hpp"
#include "app/scan_axes.hpp"
#include "base/constants.hpp"
#include "base/csv_cells.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

constexpr std::size_t most_listed_points = 10000;

class ListReader {
 public:
  explicit ListReader(std::string name) : name_(std::move(name)) {}

  ScanList read(std::string_view text) {
    for (std::size_t at = 0; at < text.size(); ++line_) {
      std::size_t const end = std::min(text.find('\n', at), text.size());
      if (std::string_view const line = without_blanks(text.substr(at, end - at)); !line.empty() && line[0] != '#')
        list_.axes.empty() ? header(line) : row(line);
      at = end + 1;
    }
    if (list_.points.empty() && problems_.empty()) problem(0, 0, "it holds no points", example);
    throw_problems();
    return std::move(list_);
  }

 private:
  static constexpr char const* example = "write a header such as 'rim [cm], baffles' and a row for each point";

  void header(std::string_view line) {
    for (CsvCell const& cell : csv_cells(line)) {
      auto const known = csv_name(cell.text);
      if (!known) problem(line_, cell.column, fmt::format("'{}' does not name a parameter", cell.text), example);
      std::size_t const open = cell.text.find('['), close = cell.text.rfind(']');
      std::string const unit = known && open != cell.text.npos && close > open
                                   ? std::string(without_blanks(cell.text.substr(open + 1, close - open - 1)))
                                   : "";
      list_.axes.push_back({known ? std::string(known->name) : "", {}, {}, unit, false});
    }
  }

  void row(std::string_view line) {
    auto const cells = csv_cells(line);
    if (cells.size() != list_.axes.size())
      return problem(line_, 1, fmt::format("{} values for {} parameters", cells.size(), list_.axes.size()),
                     "give one value for each column of the header");
    std::vector<std::string> point;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      ScanAxis& axis = list_.axes[i];
      auto const number = csv_number(cells[i].text, {1, dim::plain, {}});
      if (!number)
        problem(line_, cells[i].column, fmt::format("'{}' is not a number", cells[i].text),
                "write a number without unit; the unit stands in the header");
      axis.values.push_back(std::string(cells[i].text) + (axis.unit.empty() ? "" : " " + axis.unit));
      axis.numbers.push_back(number.value_or(not_a_number));
      point.push_back(axis.name + "=" + axis.values.back());
    }
    list_.points.push_back(std::move(point));
    if (list_.points.size() == most_listed_points + 1)
      problem(line_, 1, fmt::format("more than {} points", most_listed_points), "take fewer");
  }

  void problem(std::uint32_t line, std::uint32_t column, std::string what, std::string suggestion) {
    if (problems_.size() < 20) problems_.push_back({{0, line, column}, std::move(what), std::move(suggestion)});
  }

  void throw_problems() const {
    if (problems_.empty()) return;
    std::string text;
    for (Problem const& p : problems_)
      text +=
          fmt::format("{}:{}:{}: error: {}\n      | {}\n", name_, p.place.line, p.place.column, p.what, p.suggestion);
    throw InputError(problems_, text, {name_});
  }

  std::string name_;
  std::uint32_t line_ = 1;
  ScanList list_;
  std::vector<Problem> problems_;
};

}  // namespace

ScanList read_points(std::string const& file) { return ListReader(file).read(read_file(file)); }

}  // namespace straytrace
