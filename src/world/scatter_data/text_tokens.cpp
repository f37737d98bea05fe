// SPDX-License-Identifier: BSD-3-Clause
#include "world/scatter_data/text_tokens.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/input/document.hpp"
#include "io/csv_cells.hpp"
#include "io/number_rows.hpp"

namespace straytrace {

std::vector<TextLine> lines_of(std::string_view text) {
  std::vector<TextLine> lines;
  text = without_byte_order_mark(text);
  for (std::uint32_t number = 1; !text.empty(); ++number) {
    std::size_t const end = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view const line = text.substr(0, end);
    bool const two = text.substr(end, 2) == "\r\n";
    text.remove_prefix(std::min(end + (two ? 2 : 1), text.size()));
    std::string_view const content = line.substr(0, std::min(line.find('#'), line.size()));
    if (!without_blanks(content).empty()) lines.push_back({content, number});
  }
  return lines;
}

std::vector<Token> words_of(TextLine const& line) {
  std::vector<Token> out;
  for (std::size_t at = 0; at < line.text.size();) {
    std::size_t const begin = line.text.find_first_not_of(" \t", at);
    if (begin == line.text.npos) break;
    at = std::min(line.text.find_first_of(" \t", begin), line.text.size());
    out.push_back({line.text.substr(begin, at - begin), line.number, code_points(line.text.substr(0, begin)) + 1});
  }
  return out;
}

void complain(std::vector<Problem>& problems, Token const& where, std::string what, std::string suggestion) {
  problems.push_back({{0, where.line, where.column},
                      std::move(what),
                      std::move(suggestion),
                      Severity::error,
                      std::max(1U, code_points(where.text))});
}

void complain_of_number(std::vector<Problem>& problems, Token const& where, std::string const& what) {
  if (where.line == 0)
    return complain(problems, where, fmt::format("the file ends where {} should stand", what),
                    "it is cut off: copy it again");
  std::string pointed(where.text);
  std::replace(pointed.begin(), pointed.end(), ',', '.');
  bool const comma = pointed != where.text && is_number(pointed);
  complain(problems, where, fmt::format("'{}' is not a number; {} should stand here", shortened(where.text), what),
           comma ? "use decimal points, not decimal commas: 1.5, not 1,5" : "write a finite number without unit");
}

TokenReader::TokenReader(std::string_view text, std::vector<Problem>& problems) : problems_(problems) {
  for (TextLine const& line : lines_of(text))
    for (Token const& word : words_of(line)) tokens_.push_back(word);
}

Token TokenReader::next() {
  Token const t = peek();
  if (!done()) ++at_;
  return t;
}

std::vector<Token> TokenReader::rest_of_line(Token const& first) {
  std::vector<Token> out;
  while (!done() && peek().line == first.line) out.push_back(next());
  return out;
}

std::size_t TokenReader::words_left_in_line(Token const& first) const {
  std::size_t count = 0;
  while (at_ + count < tokens_.size() && tokens_[at_ + count].line == first.line) ++count;
  return count;
}

double TokenReader::number(std::string const& what) {
  if (!sound) return 0;
  auto const value = done() ? std::nullopt : csv_number(peek().text, {1, dim::plain, {}});
  if (!value) {
    complain_of_number(problems_, peek(), what);
    sound = false;
    return 0;
  }
  ++at_;
  return *value;
}

std::vector<double> TokenReader::numbers(std::size_t count, std::string const& what) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count && sound; ++i)
    out.push_back(number(fmt::format("{} {} of {}", what, i + 1, count)));
  return out;
}

void TokenReader::refuse(Token const& where, std::string what, std::string suggestion) {
  if (sound) complain(problems_, where, std::move(what), std::move(suggestion));
  sound = false;
}

}  // namespace straytrace
