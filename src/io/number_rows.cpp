// SPDX-License-Identifier: BSD-3-Clause
#include "io/number_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/input/document.hpp"

namespace straytrace {
namespace {

constexpr std::string_view separators = " \t,;\r";

NumberRows refused(std::string what, std::uint32_t line, std::uint32_t column) {
  return {{}, {}, std::move(what), line, column};
}

bool digit(char c) { return c >= '0' && c <= '9'; }

std::string counted(std::size_t n) { return fmt::format("{} number{}", n, n == 1 ? "" : "s"); }

}  // namespace

bool has_decimal_commas(std::string_view line) {
  line = line.substr(0, line.find_first_of("#%"));
  bool const semicolons = line.find(';') != line.npos;
  std::size_t words = 0;
  bool inside = false, beside = false;  // a comma between digits, a comma that ends or begins a word
  while (true) {
    auto const start = line.find_first_not_of(" \t;\r");
    if (start == line.npos) return inside && words >= 2 && (semicolons || !beside);
    line.remove_prefix(start);
    std::string_view const word = line.substr(0, line.find_first_of(" \t;\r"));
    line.remove_prefix(word.size());
    if (word.find_first_not_of("0123456789,+-.eE") != word.npos) return false;
    ++words;
    beside |= word.starts_with(',') || word.ends_with(',');
    for (auto at = word.find(','); at != word.npos; at = word.find(',', at + 1))
      inside |= at > 0 && at + 1 < word.size() && digit(word[at - 1]) && digit(word[at + 1]);
  }
}

std::string NumberRows::described_error() const {
  return error.empty() || error_line == 0 ? error : fmt::format("line {}: {}", error_line, error);
}

std::string_view read_row(std::string_view line, std::vector<double>& row, NonFinite words) {
  line = line.substr(0, line.find_first_of("#%"));
  while (true) {
    auto const start = line.find_first_not_of(separators);
    if (start == line.npos) return {};
    line.remove_prefix(start);
    std::string_view const word = line.substr(0, line.find_first_of(separators));
    line.remove_prefix(word.size());
    std::string_view const digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    auto const [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (status != std::errc{} || end != digits.data() + digits.size()) return word;
    if (words == NonFinite::refused && !std::isfinite(value)) return word;
    row.push_back(value);
  }
}

std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

NumberRows parse_rows(std::string_view text, NonFinite words) {
  text = without_byte_order_mark(text);
  NumberRows table;
  for (std::uint32_t number = 1; !text.empty(); ++number) {
    std::string_view const line = text.substr(0, text.find('\n'));
    std::vector<double> row;
    if (has_decimal_commas(line)) return refused("this line has decimal commas; write 0.5 instead of 0,5", number, 1);
    std::string_view const bad = read_row(line, row, words);
    if (!bad.empty())
      return refused(fmt::format("'{}' is not a number (comments start with #)", shortened(bad)), number,
                     code_points(line.substr(0, std::size_t(bad.data() - line.data()))) + 1);
    if (!row.empty() && !table.rows.empty() && row.size() != table.rows.front().size())
      return refused(
          fmt::format("this line has {}, those before have {}", counted(row.size()), table.rows.front().size()), number,
          1);
    if (!row.empty()) {
      table.rows.push_back(std::move(row));
      table.line.push_back(number);
    }
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  if (table.rows.empty()) table.error = "no numbers in it";
  return table;
}

std::optional<NumberRows> read_number_rows(Node const& file, std::size_t columns, std::string const& remedy) {
  std::string const name = file.as_word();
  if (name.empty()) return {};
  std::string const text = file.data_file(name);
  if (text.empty() && !file.document()->optional_file(file, name)) return {};  // said by data_file()
  NumberRows table = parse_rows(text);
  if (columns > 0 && !table.rows.empty() && table.rows.front().size() != columns)
    table = refused(fmt::format("this line has {}, not {}", counted(table.rows.front().size()), columns),
                    table.line.front(), 1);
  if (table.error.empty()) return table;
  file.file_problem(name, table.error_line, table.error_column, table.error, remedy);
  return {};
}

}  // namespace straytrace
