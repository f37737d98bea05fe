// SPDX-License-Identifier: BSD-3-Clause
#include "io/delimited_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/text/words.hpp"

namespace straytrace::io {
namespace {

constexpr char const* point_remedy = "use decimal points, not decimal commas: 1.5, not 1,5";
constexpr char const* one_per_column = "give one value per column, separated by commas";
constexpr std::size_t most_problems = 10;
constexpr char const* not_a_number_fault = "is not a number";

std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

// Takes the next line off a text; nothing at its end.
std::optional<std::string_view> take_line(std::string_view& text) {
  if (text.empty()) return {};
  std::size_t const end = std::min(text.find_first_of("\r\n"), text.size());
  std::string_view const line = text.substr(0, end);
  bool const two = text.substr(end, 2) == "\r\n";
  text.remove_prefix(std::min(end + (two ? 2 : 1), text.size()));
  return line;
}

}  // namespace

// Lines and cells.

std::vector<TextLine> text_lines(std::string_view text, Comments comments) {
  std::vector<TextLine> lines;
  text = without_byte_order_mark(text);
  for (std::uint32_t number = 1; auto line = take_line(text); ++number) {
    if (comments == Comments::anywhere) *line = line->substr(0, line->find('#'));
    std::string_view const content = without_blanks(*line);
    if (!content.empty() && (content.front() != '#' || comments == Comments::kept)) lines.push_back({*line, number});
  }
  return lines;
}

std::string_view without_blanks(std::string_view s) {
  auto const first = s.find_first_not_of(" \t\r");
  return first == s.npos ? std::string_view() : s.substr(first, s.find_last_not_of(" \t\r") + 1 - first);
}

std::vector<TextCell> comma_cells(TextLine const& line) {
  std::vector<TextCell> cells;
  std::size_t counted = 0;  // bytes whose code points are counted
  std::uint32_t points = 0;
  for (std::size_t begin = 0;;) {
    std::size_t const comma = std::min(line.text.find(',', begin), line.text.size());
    std::string_view const raw = line.text.substr(begin, comma - begin), text = without_blanks(raw);
    std::size_t const start = text.empty() ? begin : begin + std::size_t(text.data() - raw.data());
    points += code_points(line.text.substr(counted, start - counted));
    counted = start;
    cells.push_back({text, line.number, points + 1});
    if (comma == line.text.size()) return cells;
    begin = comma + 1;
  }
}

std::vector<TextCell> words_of(TextLine const& line) {
  std::vector<TextCell> out;
  for (std::size_t at = 0; at < line.text.size();) {
    std::size_t const begin = line.text.find_first_not_of(" \t", at);
    if (begin == line.text.npos) break;
    at = std::min(line.text.find_first_of(" \t", begin), line.text.size());
    out.push_back({line.text.substr(begin, at - begin), line.number, code_points(line.text.substr(0, begin)) + 1});
  }
  return out;
}

std::optional<ColumnTitle> column_title(std::string_view cell) {
  std::size_t const open = cell.find('[');
  ColumnTitle out{without_blanks(cell.substr(0, open))};
  if (out.name.empty()) return {};
  if (open == cell.npos) return out;
  std::string_view const inside = cell.substr(open + 1);
  if (!inside.ends_with(']')) return {};
  out.written_unit = without_blanks(inside.substr(0, inside.size() - 1));
  auto const unit = parse_unit(out.written_unit);
  if (!unit) return {};
  out.unit = *unit;
  return out;
}

std::optional<double> number_in(std::string_view text, Quantity const& unit) {
  if (!is_number(text)) return {};
  text.remove_prefix(text.front() == '+' ? 1 : 0);
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  double const si = to_si(value, unit);
  return std::isfinite(si) && (si != 0 || value == 0) ? std::optional(si) : std::nullopt;
}

void complain(std::vector<Problem>& problems, TextCell const& where, std::string what, std::string suggestion) {
  problems.push_back({{0, where.line, where.column},
                      std::move(what),
                      std::move(suggestion),
                      Severity::error,
                      std::max(1U, code_points(where.text))});
}

void complain_of_number(std::vector<Problem>& problems, TextCell const& where, std::string const& what) {
  if (where.line == 0)
    return complain(problems, where, fmt::format("the file ends where {} is expected", what),
                    "it is truncated: copy it again");
  std::string pointed(where.text);
  std::replace(pointed.begin(), pointed.end(), ',', '.');
  bool const comma = pointed != where.text && is_number(pointed);
  complain(problems, where,
           fmt::format("'{}' {}; {} is expected here", shortened(where.text), number_fault(where.text), what),
           comma ? point_remedy : "write a finite number without unit");
}

std::string surplus_remedy(std::span<TextCell const> cells) {
  bool const points = std::ranges::any_of(cells, [](TextCell const& c) { return c.text.find('.') != c.text.npos; });
  return points ? one_per_column : point_remedy;
}

// Tables with a header.

namespace {

class CsvReader {
 public:
  CsvReader(std::string const& example, std::span<std::string_view const> numeric, std::vector<Problem>& problems)
      : example_(example), numeric_(numeric), problems_(problems) {}

  CsvTable read(std::string_view text, Comments comments) {
    std::size_t const before = problems_.size();
    most_ = before + most_problems;
    table_.text = std::make_shared<std::string const>(with_plain_spaces(text));
    for (TextLine const& line : text_lines(*table_.text, comments)) {
      bool const in_header = table_.columns.empty();
      in_header ? header(line) : row(line);
      if (in_header && problems_.size() > before) table_.columns.clear();
      if (problems_.size() >= (in_header ? before + 1 : most_)) break;
    }
    if (problems_.size() == before && table_.rows.empty())
      complain(problems_, {}, "the table has no rows",
               fmt::format("write rows of numbers below a header '{}'", example_));
    table_.whole = problems_.size() == before;
    return std::move(table_);
  }

 private:
  bool has_semicolons(TextLine const& line) {
    std::size_t const at = line.text.find(';');
    if (at == line.text.npos) return false;
    complain(problems_, {line.text.substr(at, 1), line.number, code_points(line.text.substr(0, at)) + 1},
             "columns are separated by ';'",
             "separate values by commas, not semicolons, and write decimal points: 1.5, not 1,5");
    return true;
  }

  void header(TextLine const& line) {
    if (has_semicolons(line)) return;
    for (TextCell const& cell : cells_in(line)) {
      auto const title = column_title(cell.text);
      bool const number = title && is_number(title->name);
      std::string const name(title ? title->name : "");
      if (!title || number)
        complain(problems_, cell, fmt::format("cannot read the column name '{}'", shortened(cell.text)),
                 fmt::format("begin with a header of names and units such as '{}'", example_));
      else if (!names_.insert(name).second)
        complain(problems_, cell, fmt::format("column '{}' appears twice", name), "remove one of them");
      else
        table_.columns.push_back({name, title->unit, std::string(title->written_unit), cell.line, cell.column});
      if (number) return;  // there is no header
    }
  }

  bool is_numeric(std::size_t column) const {
    return numeric_.empty() || std::ranges::find(numeric_, table_.columns[column].name) != numeric_.end();
  }

  // Without quotes around single cells, and without empty cells behind the last column, which spreadsheets write.
  std::vector<TextCell> cells_in(TextLine const& line) const {
    std::vector<TextCell> cells = comma_cells(line);
    while (cells.size() > std::max<std::size_t>(table_.columns.size(), 1) && cells.back().text.empty())
      cells.pop_back();
    for (TextCell& cell : cells)
      if (cell.text.size() > 1 && cell.text.front() == '"' && cell.text.back() == '"')
        cell.text = without_blanks(cell.text.substr(1, cell.text.size() - 2));
    return cells;
  }

  void row(TextLine const& line) {
    if (has_semicolons(line)) return;
    std::size_t const columns = table_.columns.size();
    CsvTable::Row row{{}, cells_in(line)};
    while (row.cells.size() < columns && !is_numeric(row.cells.size())) row.cells.push_back({"", line.number, 1});
    if (row.cells.size() != columns)
      return complain(
          problems_, {line.text.substr(0, 1), line.number, 1},
          fmt::format("{}, but the header has {}", counted(row.cells.size(), "value"), counted(columns, "column")),
          row.cells.size() > columns ? surplus_remedy(row.cells) : one_per_column);
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      auto const value = is_numeric(i) ? number_in(row.cells[i].text, table_.columns[i].unit) : not_a_number;
      if (value)
        row.values.push_back(*value);
      else if (problems_.size() < most_)
        refuse_cell(row.cells[i]);
    }
    if (row.values.size() == columns) table_.rows.push_back(std::move(row));
  }

  void refuse_cell(TextCell const& cell) {
    complain(problems_, cell, fmt::format("'{}' {}", shortened(cell.text), number_fault(cell.text)),
             cell.text.find('"') != cell.text.npos
                 ? point_remedy
                 : "write a finite number without unit; the unit belongs in the header");
  }

  std::string example_;
  std::span<std::string_view const> numeric_;
  std::vector<Problem>& problems_;
  std::size_t most_ = most_problems;  // problems, with those that were there before
  CsvTable table_;
  std::set<std::string> names_;
};

}  // namespace

std::string wrong_unit(CsvTable::Column const& column, Dimension wanted) {
  std::string const is = fmt::format("column '{}' is {}", shortened(column.name), described(wanted));
  return column.written_unit.empty() ? is + " and needs its unit"
                                     : fmt::format("{}, its unit is {}", is, described(column.unit.dimension));
}

int CsvTable::find(std::string_view column) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == column) return int(i);
  return -1;
}

CsvTable parse_csv_table(std::string_view text, Comments comments, std::string const& example,
                         std::vector<Problem>& problems, std::span<std::string_view const> numeric) {
  return CsvReader(example, numeric, problems).read(text, comments);
}

CsvTable read_csv_table(Node const& owner, std::string const& file, Comments comments, std::string const& example) {
  std::string const text = owner.data_file(file);
  if (text.empty() && !owner.document()->optional_file(owner, file)) return {};  // data_file() reports it
  std::vector<Problem> problems;
  CsvTable table = parse_csv_table(text, comments, example, problems);
  for (Problem const& p : problems) owner.file_problem(file, p.place.line, p.place.column, p.what, p.suggestion);
  return table;
}

// Columns of numbers.

namespace {

constexpr std::string_view separators = " \t,;\r";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// "0,5 1,2", "10,5;1e-9": a comma between digits in a line of numbers with another separator. In "0,5, 1" commas are
// the separators.
bool has_decimal_commas(std::string_view line) {
  line = line.substr(0, line.find_first_of("#%"));
  bool const semicolons = line.find(';') != line.npos;
  std::size_t words = 0;
  bool inside = false, separates = false;  // a comma between digits, a comma that ends or begins a word
  while (true) {
    auto const start = line.find_first_not_of(" \t;\r");
    if (start == line.npos) return inside && words >= 2 && (semicolons || !separates);
    line.remove_prefix(start);
    std::string_view const word = line.substr(0, line.find_first_of(" \t;\r"));
    line.remove_prefix(word.size());
    if (word.find_first_not_of("0123456789,+-.eE") != word.npos) return false;
    ++words;
    separates |= word.starts_with(',') || word.ends_with(',');
    for (auto at = word.find(','); at != word.npos; at = word.find(',', at + 1))
      inside |= at > 0 && at + 1 < word.size() && is_digit(word[at - 1]) && is_digit(word[at + 1]);
  }
}

struct NumberRow {
  std::vector<double> values;
  std::vector<std::string_view> wrong;  // words that are no numbers, views into the line
  bool begins_wrong = false;            // before any number
};

NumberRow read_row(std::string_view line, NonFinite words) {
  NumberRow row;
  line = line.substr(0, line.find_first_of("#%"));
  while (true) {
    auto const start = line.find_first_not_of(separators);
    if (start == line.npos) return row;
    line.remove_prefix(start);
    std::string_view const word = line.substr(0, line.find_first_of(separators));
    line.remove_prefix(word.size());
    std::string_view const digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    auto const [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    bool const sound = status == std::errc{} && end == digits.data() + digits.size();
    if (sound && (words == NonFinite::kept || std::isfinite(value))) {
      row.values.push_back(value);
    } else {
      row.begins_wrong |= row.values.empty();
      row.wrong.push_back(word);
    }
  }
}

std::string without_quotes(std::string_view text) {
  auto const first = text.find_first_not_of(" \t\r\""), last = text.find_last_not_of(" \t\r\"");
  return first == text.npos ? "" : std::string(text.substr(first, last + 1 - first));
}

// Entries of a row of words: between commas, semicolons or tabs where there are any, otherwise between blanks; "[um]"
// belongs to the word before it.
std::vector<std::string> titles_of(std::string_view line) {
  bool const marked = line.find_first_of(",;\t") != line.npos;
  std::vector<std::string> found;
  std::string title;
  int depth = 0;
  auto const finish = [&] {
    if (std::string const text = without_quotes(title); !text.empty() && !marked && text[0] == '[' && !found.empty())
      found.back() += " " + text;
    else if (marked || !text.empty())
      found.push_back(text);
    title.clear();
  };
  for (char const c : line) {
    depth += (c == '[' || c == '(') - (c == ']' || c == ')');
    bool const end = marked ? c == ',' || c == ';' || c == '\t' : c == ' ' || c == '\r';
    if (end && depth <= 0)
      finish();
    else
      title += c;
  }
  finish();
  return found;
}

class NumberReader {
 public:
  NumberReader(NonFinite words, HeaderRow header) : words_(words), header_(header) {}

  NumberTable read(std::string_view text) {
    text = without_byte_order_mark(text);
    std::string spaced;
    // Without a row of numbers before it, the first problem is the only one.
    for (std::uint32_t number = 1; table_.problems.size() < (table_.line.empty() ? 1 : most_problems); ++number) {
      auto const line = take_line(text);
      if (!line) break;
      bool const plain = line->find_first_of("\xc2\xe2") == line->npos;  // as in all files of numbers alone
      take(plain ? *line : std::string_view(spaced = with_plain_spaces(*line)), number);
    }
    if (table_.problems.empty() && table_.line.empty()) fail("no numbers in it", 0, 0);
    if (table_.problems.empty()) name_columns();
    if (!table_.problems.empty()) table_.column.clear(), table_.line.clear();
    return std::move(table_);
  }

 private:
  void fail(std::string what, std::uint32_t line, std::uint32_t column = 1) {
    table_.problems.push_back({{0, line, column}, std::move(what), ""});
  }

  void take(std::string_view line, std::uint32_t number) {
    auto const start = line.find_first_not_of(" \t\r#%");
    if (start == line.npos) return;
    if (line.substr(0, start).find_first_of("#%") != line.npos) {  // a comment
      if (table_.line.empty()) comments_.push_back(titles_of(line.substr(start)));
      return;
    }
    if (has_decimal_commas(line))
      return fail(fmt::format("'{}' has decimal commas; write 0.5 instead of 0,5", shortened(without_blanks(line))),
                  number);
    NumberRow const row = read_row(line, words_);
    if (row.begins_wrong && header_ == HeaderRow::allowed && table_.line.empty() && titles_.empty())
      titles_ = titles_of(line.substr(0, line.find('#')));
    else if (!row.wrong.empty())
      refuse_words(row, line, number);
    else if (!row.values.empty())
      add(row.values, number);
    points_ |= line.find('.') != line.npos;
  }

  // In a line without any number the first word stands for all.
  void refuse_words(NumberRow const& row, std::string_view line, std::uint32_t number) {
    for (std::string_view const word : row.wrong) {
      std::string const fault = number_fault(word);
      fail(fmt::format("'{}' {}{}", shortened(word), fault,
                       fault == not_a_number_fault ? " (comments start with #)" : ""),
           number, code_points(line.substr(0, std::size_t(word.data() - line.data()))) + 1);
      if (row.values.empty() || table_.problems.size() >= most_problems) return;
    }
  }

  void add(std::vector<double> const& row, std::uint32_t number) {
    if (table_.column.empty()) table_.column.resize(row.size());
    if (row.size() != table_.column.size())
      return fail(fmt::format("this line has {}, the lines before have {}", counted(row.size(), "number"),
                              table_.column.size()),
                  number);
    for (std::size_t i = 0; i < row.size(); ++i) table_.column[i].push_back(row[i]);
    table_.line.push_back(number);
  }

  // A comment that names units has priority over one that does not, a later over an earlier.
  std::vector<std::string> titles_in_comments() const {
    std::vector<std::string> found;
    bool with_units = false;
    for (auto const& titles : comments_) {
      bool const units = std::ranges::any_of(titles, [](auto const& c) { return c.ends_with(']'); });
      if (titles.size() != table_.column.size() || (with_units && !units)) continue;
      found = titles;
      with_units = units;
    }
    return found;
  }

  void name_columns() {
    std::size_t const columns = table_.column.size();
    if (titles_.empty()) titles_ = titles_in_comments();
    if (!titles_.empty() && titles_.size() != columns)
      return fail(fmt::format("{}, and the row of names has {}{}", counted(columns, "number"), titles_.size(),
                              points_ ? "" : " (numbers are written with a point, 0.5, not with a comma)"),
                  table_.line.front());
    titles_.resize(columns);
    for (std::string const& title : titles_) name_column(title);
  }

  // "x [um]" and "x (um)".
  void name_column(std::string const& title) {
    for (auto const& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}})
      if (auto const begin = title.find(open); begin != title.npos && begin > 0 && title.back() == close) {
        table_.name.push_back(without_quotes(title.substr(0, begin)));
        table_.unit.push_back(without_quotes(title.substr(begin + 1, title.size() - begin - 2)));
        return;
      }
    table_.name.push_back(title);
    table_.unit.emplace_back();
  }

  NonFinite words_;
  HeaderRow header_;
  bool points_ = false;                             // a number with a decimal point was read
  std::vector<std::string> titles_;                 // the row of words
  std::vector<std::vector<std::string>> comments_;  // titles that the comments above the numbers may be
  NumberTable table_;
};

}  // namespace

NumberTable parse_numbers(std::string_view text, NonFinite words, HeaderRow header) {
  return NumberReader(words, header).read(text);
}

std::optional<NumberTable> read_numbers(Node const& file, std::size_t columns, std::string const& remedy) {
  std::string const name = file.as_word();
  if (name.empty()) return {};
  std::string const text = file.data_file(name);
  if (text.empty() && !file.document()->optional_file(file, name)) return {};  // data_file() reports it
  NumberTable table = parse_numbers(text);
  if (table.problems.empty() && columns > 0 && table.column.size() != columns)
    table.problems.push_back({{0, table.line.front(), 1},
                              fmt::format("this line has {}, not {}", counted(table.column.size(), "number"), columns),
                              ""});
  if (table.problems.empty()) return table;
  for (Problem const& p : table.problems) file.file_problem(name, p.place.line, p.place.column, p.what, remedy);
  return {};
}

// Texts of keywords and numbers.

WordReader::WordReader(std::string_view text, std::vector<Problem>& problems)
    : problems_(problems), text_(std::make_shared<std::string const>(with_plain_spaces(text))) {
  for (TextLine const& line : text_lines(*text_, Comments::anywhere))
    for (TextCell const& word : words_of(line)) words_.push_back(word);
}

TextCell WordReader::next() {
  TextCell const word = peek();
  if (!done()) ++at_;
  return word;
}

std::vector<TextCell> WordReader::rest_of_line(TextCell const& first) {
  std::vector<TextCell> out;
  while (!done() && peek().line == first.line) out.push_back(next());
  return out;
}

std::size_t WordReader::words_left_in_line(TextCell const& first) const {
  std::size_t count = 0;
  while (at_ + count < words_.size() && words_[at_ + count].line == first.line) ++count;
  return count;
}

double WordReader::number(std::string const& what) {
  if (!sound) return 0;
  auto const value = done() ? std::nullopt : number_in(peek().text);
  if (!value) {
    complain_of_number(problems_, peek(), what);
    sound = false;
    return 0;
  }
  ++at_;
  return *value;
}

std::vector<double> WordReader::numbers(std::size_t count, std::string const& what) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count && sound; ++i)
    out.push_back(number(fmt::format("{} {} of {}", what, i + 1, count)));
  return out;
}

void WordReader::refuse(TextCell const& where, std::string what, std::string suggestion) {
  if (sound) complain(problems_, where, std::move(what), std::move(suggestion));
  sound = false;
}

}  // namespace straytrace::io
