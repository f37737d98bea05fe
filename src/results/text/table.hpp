// SPDX-License-Identifier: BSD-3-Clause
// The columns of a table. A table states each of its columns once, as a TableColumn in a list; text, CSV, JSON, pages
// and filters are made from that list.
#pragma once

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/namespaces.hpp"
#include "results/text/columns.hpp"

namespace straytrace::results {

// The content of a column in one row. Unknown numbers are NaN.
using TableCell = std::variant<std::string, bool, std::uint64_t, double, WithError>;

// The form of a column in one output. Each output sorts its columns by `place`; equal places keep the order of the
// list.
struct InOutput {
  int place = 0;          // 0: this output does not have the column
  std::string name = {};  // heading or key; empty: the key of the column. In JSON a path: "coupling/value"
  double scale = 1;       // factor on the value
  int digits = 3;         // of numbers on pages
};

// estimate: a number with its standard error; CSV and pages add a column KEY_sigma.
enum class ColumnKind : std::uint8_t { text, flag, count, number, estimate, list };
std::string_view name_of(ColumnKind);

template <class Row>
struct TableColumn {
  std::string key;  // name in filters, pages and Python
  ColumnKind kind = ColumnKind::number;
  std::string title = {}, unit = {};  // unit of the value, before any scale
  std::string help = {};              // one phrase
  std::function<TableCell(Row const&)> value = {};
  InOutput text = {}, csv = {}, json = {}, page = {}, file = {};   // file: the run file, of what needs no noise
  std::string page_unit = {};                                      // of the scaled value; empty: `unit`
  std::string format = "{:.3g}";                                   // of numbers in text
  bool left = false;                                               // text is aligned left
  bool shown_first = false;                                        // on pages, before the reader chooses columns
  std::function<std::string(Row const&)> as_text = {};             // replaces the default text
  std::function<nlohmann::ordered_json(Row const&)> as_json = {};  // replaces the default JSON; discarded: no entry
  std::function<nlohmann::ordered_json(Row const&)> as_page = {};  // replaces the default cell of pages

  std::string const& shown_unit() const { return page_unit.empty() ? unit : page_unit; }
  std::string const& name_in(InOutput TableColumn::*output) const {
    return (this->*output).name.empty() ? key : (this->*output).name;
  }
};

std::string cell_text(TableCell const&, std::string const& format);  // "-" for unknown numbers
std::string cell_csv(TableCell const&, double scale);                // WithError: "value,sigma"
nlohmann::ordered_json cell_json(TableCell const&, double scale);    // WithError: {value, sigma[, at_most]}
nlohmann::ordered_json error_json(WithError const&);

// Writes the rows of a table in every format.
template <class Row>
class TableWriter {
 public:
  explicit TableWriter(std::vector<TableColumn<Row>> columns) : all_(std::move(columns)) {}
  TableWriter(TableWriter const&) = delete;  // the orders point into the list

  // The columns of one output, in its order.
  std::vector<TableColumn<Row> const*> of(InOutput TableColumn<Row>::*output) const {
    std::vector<TableColumn<Row> const*> some;
    for (TableColumn<Row> const& c : all_)
      if ((c.*output).place > 0) some.push_back(&c);
    std::stable_sort(some.begin(), some.end(),
                     [&](auto const* a, auto const* b) { return (a->*output).place < (b->*output).place; });
    return some;
  }

  Columns text_head() const {
    Columns out;
    for (TableColumn<Row> const* c : text_) {
      out.titles.push_back(c->name_in(&TableColumn<Row>::text));
      out.left.push_back(c->left);
    }
    return out;
  }
  std::vector<std::string> text_row(Row const& row) const {
    std::vector<std::string> cells;
    for (TableColumn<Row> const* c : text_) cells.push_back(shown(*c, row));
    return cells;
  }
  // A line of sums: cells by the key of their column, the others empty.
  std::vector<std::string> text_cells(std::map<std::string, std::string> const& by_key) const {
    std::vector<std::string> cells;
    for (TableColumn<Row> const* c : text_) cells.push_back(by_key.contains(c->key) ? by_key.at(c->key) : "");
    return cells;
  }
  static std::string shown(TableColumn<Row> const& c, Row const& row) {
    return c.as_text ? c.as_text(row) : cell_text(c.value(row), c.format);
  }

  std::string csv_head() const {
    std::string line;
    for (TableColumn<Row> const* c : csv_) {
      std::string const& name = c->name_in(&TableColumn<Row>::csv);
      line += (line.empty() ? "" : ",") + name + (c->kind == ColumnKind::estimate ? "," + name + "_sigma" : "");
    }
    return line + "\n";
  }
  std::string csv_row(Row const& row) const {
    std::string line;
    for (TableColumn<Row> const* c : csv_)
      line += (c == csv_.front() ? "" : ",") + cell_csv(c->value(row), c->csv.scale);
    return line + "\n";
  }

  nlohmann::ordered_json json_row(Row const& row) const {
    nlohmann::ordered_json out;
    for (TableColumn<Row> const* c : json_) {
      auto entry = c->as_json ? c->as_json(row) : cell_json(c->value(row), c->json.scale);
      if (!entry.is_discarded()) out[pointer(*c)] = std::move(entry);
    }
    return out;
  }
  // The place of each column in a JSON row: {key, at, kind, unit, help}.
  nlohmann::ordered_json json_columns() const {
    auto out = nlohmann::ordered_json::array();
    for (TableColumn<Row> const* c : json_)
      out.push_back({{"key", c->key},
                     {"at", pointer(*c).to_string()},
                     {"kind", name_of(c->kind)},
                     {"unit", c->unit},
                     {"help", c->help}});
    return out;
  }

  // For pages: columns {title, text, digits} and rows of cells.
  nlohmann::ordered_json page_table(std::vector<Row> const& rows) const {
    using Json = nlohmann::ordered_json;
    auto const columns = of(&TableColumn<Row>::page);
    Json out{{"columns", Json::array()}, {"rows", Json::array()}};
    for (TableColumn<Row> const* c : columns)
      out["columns"].push_back({{"title", c->name_in(&TableColumn<Row>::page)},
                                {"text", c->kind == ColumnKind::text},
                                {"digits", c->page.digits}});
    for (Row const& row : rows) {
      Json cells = Json::array();
      for (TableColumn<Row> const* c : columns)
        cells.push_back(c->as_page ? c->as_page(row) : cell_json(c->value(row), c->page.scale));
      out["rows"].push_back(std::move(cells));
    }
    return out;
  }

 private:
  static nlohmann::ordered_json::json_pointer pointer(TableColumn<Row> const& c) {
    return nlohmann::ordered_json::json_pointer("/" + c.name_in(&TableColumn<Row>::json));
  }
  std::vector<TableColumn<Row>> all_;
  std::vector<TableColumn<Row> const*> text_ = of(&TableColumn<Row>::text), csv_ = of(&TableColumn<Row>::csv),
                                       json_ = of(&TableColumn<Row>::json);
};

// Tables that are printed as text, CSV or JSON.

struct Sheet {
  struct Column {
    std::string key, unit;  // "power", "W"; without unit: text or a plain number
    int digits = 6;         // of a number in the text
    double scale = 1;       // of the text, to the unit `shown`
    std::string shown{};
  };
  using Cell = std::variant<std::string, double>;  // not a number: unknown
  std::string name, heading;                       // key of the JSON; line above the text
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

std::string text_of(std::vector<Sheet> const&);
std::string csv_of(std::vector<Sheet> const&);  // "# NAME" before each of several
// Titles, cells as in the text and which columns are text, for a page.
nlohmann::ordered_json page_of(std::vector<Sheet> const&);
nlohmann::ordered_json json_of(std::vector<Sheet> const&);

}  // namespace straytrace::results
