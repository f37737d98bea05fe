// SPDX-License-Identifier: BSD-3-Clause
// The parser of all text tables: lines, cells and words with their places, tables with a header ('z [m], aperture'),
// columns of numbers, and texts of keywords. Columns of a place count code points from 1. No-break and thin spaces are
// read as spaces, except between digits, where they are an error.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "base/units/quantity.hpp"

namespace straytrace::io {

// Lines and cells.

struct TextLine {
  std::string_view text;  // without comment and line end
  std::uint32_t number = 0;
};
// Without a leading byte order mark. Lines end with LF, CR LF or CR; lines without content are left out.
enum class Comments : std::uint8_t { kept, whole_lines, anywhere };  // which comments, from '#' on, are left out
std::vector<TextLine> text_lines(std::string_view text, Comments);

struct TextCell {
  std::string_view text;
  std::uint32_t line = 0, column = 0;  // from 1; line 0: the file as a whole, or its end
};
std::vector<TextCell> comma_cells(TextLine const&);  // without the blanks around them; quotes are part of the text
std::vector<TextCell> words_of(TextLine const&);     // between blanks
// Without spaces, tabs and carriage returns at either end.
std::string_view without_blanks(std::string_view);

// "z [m]": name and unit, a plain number without brackets. Empty without a name or with an unknown unit.
struct ColumnTitle {
  std::string_view name;
  Quantity unit{1, dim::plain, {}};
  std::string_view written_unit = {};
};
std::optional<ColumnTitle> column_title(std::string_view cell);

// A number in `unit`, in SI; empty for other texts and outside the range of double precision.
std::optional<double> number_in(std::string_view text, Quantity const& unit = {1, dim::plain, {}});

// A problem at a cell.
void complain(std::vector<Problem>&, TextCell const&, std::string what, std::string suggestion);
// Of a row with more values than columns.
std::string surplus_remedy(std::span<TextCell const>);
// "'ten' is not a number; the angle is expected here", with the remedy.
void complain_of_number(std::vector<Problem>&, TextCell const&, std::string const& what);

// Tables with a header.

struct CsvTable {
  struct Column {
    std::string name;
    Quantity unit;
    std::string written_unit;
    std::uint32_t line, at;  // place of the title
  };
  struct Row {
    std::vector<double> values;  // SI
    std::vector<TextCell> cells;
    std::uint32_t line() const { return cells.front().line; }
  };
  std::vector<Column> columns;
  std::vector<Row> rows;                    // those without problems
  bool whole = false;                       // no problems
  std::shared_ptr<std::string const> text;  // which the cells point into

  int find(std::string_view column) const;  // -1: none
};
// Why a column does not have this dimension: "column 'z' is a length, its unit is a time", or it "needs its unit".
std::string wrong_unit(CsvTable::Column const&, Dimension wanted);
// Header, then rows of as many finite numbers. Adds the first ten problems; after one in the header there are no
// columns. `example`: a header for messages. `numeric`: names of the columns of numbers, where the others are texts
// that may be missing at the end of a row.
CsvTable parse_csv_table(std::string_view text, Comments, std::string const& example, std::vector<Problem>&,
                         std::span<std::string_view const> numeric = {});
// The same for a data file next to the scene, with the problems at its lines.
CsvTable read_csv_table(Node const& owner, std::string const& file, Comments, std::string const& example);

// Columns of numbers.

// Numbers between blanks, tabs, commas or semicolons; '#' and '%' start comments; lines without numbers are left out.
// A name and a unit of each column may stand in a first row of words, where it is allowed, or in a comment above the
// numbers that has as many entries as there are columns: "x [um]" or "x (um)".
struct NumberTable {
  std::vector<std::vector<double>> column;
  std::vector<std::uint32_t> line;      // of each row, from 1
  std::vector<std::string> name, unit;  // of each column; empty without a title
  // Up to ten, with their places (line 0: the text as a whole) and without remedies. Then there are no columns.
  std::vector<Problem> problems;

  std::size_t rows() const { return line.size(); }
  std::vector<double> row(std::size_t i) const {
    std::vector<double> values;
    for (auto const& c : column) values.push_back(c[i]);
    return values;
  }
};
enum class NonFinite : bool { refused, kept };     // words such as nan and inf
enum class HeaderRow : bool { refused, allowed };  // a first row of words
NumberTable parse_numbers(std::string_view text, NonFinite = NonFinite::refused, HeaderRow = HeaderRow::refused);

// The data file that `file` names, with `columns` in each row (0: any number). Empty, and a problem at its line, when
// it is no such table; `remedy` states what to write there.
std::optional<NumberTable> read_numbers(Node const& file, std::size_t columns, std::string const& remedy);

// Texts of keywords and numbers.

// Reads words one after the other. The first mismatch is a problem and clears `sound`; later calls do nothing.
class WordReader {
 public:
  WordReader(std::string_view text, std::vector<Problem>& problems);

  bool done() const { return at_ == words_.size(); }
  TextCell peek() const { return done() ? TextCell{} : words_[at_]; }
  TextCell next();
  bool is_next(std::string_view word) const { return !done() && words_[at_].text == word; }
  std::vector<TextCell> rest_of_line(TextCell const& first);  // the words after `first` in its line
  std::size_t words_left_in_line(TextCell const& first) const;
  double number(std::string const& what);
  std::vector<double> numbers(std::size_t count, std::string const& what);
  void refuse(TextCell const&, std::string what, std::string suggestion);

  bool sound = true;

 private:
  std::vector<Problem>& problems_;
  std::shared_ptr<std::string const> text_;  // which the words point into
  std::vector<TextCell> words_;
  std::size_t at_ = 0;
};

}  // namespace straytrace::io
