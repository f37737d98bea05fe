// SPDX-License-Identifier: BSD-3-Clause
#include "world/share_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/document.hpp"
#include "base/number_rows.hpp"

namespace straytrace {
namespace {

std::string_view trimmed(std::string_view s) {
  auto const first = s.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view()
                                         : s.substr(first, s.find_last_not_of(" \t\r") + 1 - first);
}
std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    std::size_t const comma = std::min(line.find(',', begin), line.size());
    cells.push_back(trimmed(line.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  return cells;
}

// A text file: header 'angle [deg], reflect, transmit [%]', then one row per angle and wavelength; '#' starts a
// comment.
class ShareFile {
 public:
  ShareFile(Node const& node, std::string name) : node_(node) { table_.file = std::move(name); }

  ShareTable read() {
    std::string const text = node_.data_file(table_.file);
    std::string_view rest = text;
    rest = without_byte_order_mark(rest);
    for (std::uint32_t number = 1; !rest.empty() && healthy_; ++number) {
      std::size_t const end = std::min(rest.find('\n'), rest.size());
      std::string_view const line = trimmed(rest.substr(0, std::min(end, rest.find('#'))));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (line.empty()) continue;
      if (names_.empty())
        header(line, number);
      else
        row(line, number);
    }
    if (healthy_ && table_.angle.empty() && !text.empty())
      problem(0, "the table has no rows", "write one row per angle below the header 'angle [deg], reflect, transmit'");
    return healthy_ ? table_ : ShareTable{};
  }

 private:
  void problem(std::uint32_t line, std::string what, std::string suggestion) {
    healthy_ = false;
    node_.file_problem(table_.file, line, 1, std::move(what), std::move(suggestion));
  }

  void header(std::string_view line, std::uint32_t number) {
    for (std::string_view const cell : cells_of(line)) {
      std::size_t const open = cell.find('[');
      std::string const name(trimmed(cell.substr(0, open)));
      auto unit = std::optional(Quantity{1, dim::plain, {}});
      if (open != std::string_view::npos)
        unit = cell.ends_with(']') ? parse_unit(trimmed(cell.substr(open + 1, cell.size() - open - 2))) : std::nullopt;
      auto const& known = share_columns();
      bool const angle = name == "angle", wavelength = name == "wavelength";
      if (!angle && !wavelength && std::find(known.begin(), known.end(), name) == known.end()) {
        std::string const near = nearest_word(name, known);
        return problem(number, fmt::format("unknown column '{}'", shortened(name)),
                       near.empty()
                           ? "known columns: angle, wavelength, reflect, reflect_s, reflect_p, transmit, transmit_s, "
                             "transmit_p, scatter, absorb; separate them by commas"
                           : fmt::format("did you mean '{}'?", near));
      }
      if (!unit || unit->dimension != (angle ? dim::angle : wavelength ? dim::length : dim::plain))
        return problem(number, fmt::format("column '{}' needs its unit", name),
                       angle        ? "write 'angle [deg]'"
                       : wavelength ? "write 'wavelength [nm]'"
                                    : fmt::format("write '{}' or '{} [%]'", name, name));
      if (std::find(names_.begin(), names_.end(), name) != names_.end())
        return problem(number, fmt::format("column '{}' appears twice", name), "remove one of them");
      names_.push_back(name);
      units_.push_back(*unit);
    }
    if (std::find(names_.begin(), names_.end(), "angle") == names_.end())
      problem(number, "no column of angles", "name one column 'angle [deg]'");
  }

  void row(std::string_view line, std::uint32_t number) {
    auto const cells = cells_of(line);
    if (cells.size() != names_.size())
      return problem(number, fmt::format("{} values, but the header has {} columns", cells.size(), names_.size()),
                     cells.size() > names_.size() ? "use decimal points, not decimal commas: 1.5, not 1,5"
                                                  : "give one value per column");
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = 0;
      if (!is_number(cells[i]))
        return problem(number, fmt::format("'{}' is not a number", shortened(cells[i])),
                       "write a number without unit; the unit stands in the header");
      std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), value);
      column(names_[i]).push_back(to_si(value, units_[i]));
    }
    table_.line.push_back(number);
  }

  std::vector<double>& column(std::string const& name) {
    return name == "angle" ? table_.angle : name == "wavelength" ? table_.wavelength : table_.columns[name];
  }

  Node node_;
  ShareTable table_;
  std::vector<std::string> names_;
  std::vector<Quantity> units_;
  bool healthy_ = true;
};

}  // namespace

std::vector<std::string> const& share_columns() {
  static std::vector<std::string> const names = {"reflect",    "reflect_s",  "reflect_p", "transmit",
                                                 "transmit_s", "transmit_p", "scatter",   "absorb"};
  return names;
}

ShareTable read_share_table(Node const& node) {
  if (node.has("file")) {
    Node const name = node["file"];
    std::string const file = name.as_word();
    return file.empty() ? ShareTable{} : ShareFile(name, file).read();
  }
  ShareTable table;
  auto const angles = node["angle"].as_list();
  if (angles.size() < 2) {
    node.problem("a coating needs two angles or more",
                 "write {angle: [0 deg, 60 deg, 90 deg], reflect: [0.01, 0.05, 1]}, {file: NAME}, or a preset");
    return {};
  }
  table.angle = node["angle"].as_numbers(dim::angle, angles.size());
  for (std::string const& name : share_columns())
    if (node.has(name)) table.columns[name] = node[name].as_numbers(dim::plain, angles.size());
  if (node.has("wavelength")) {
    table.wavelength = node["wavelength"].as_numbers(dim::length, angles.size());
    if (table.wavelength.size() != table.angle.size()) return {};
  }
  for (auto const& [name, column] : table.columns)
    if (column.size() != table.angle.size()) return {};
  return table.angle.size() == angles.size() ? table : ShareTable{};
}

}  // namespace straytrace
