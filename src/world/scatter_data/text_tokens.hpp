// SPDX-License-Identifier: BSD-3-Clause
// Words and numbers of text files with keywords, with their places. Lines end with LF, CR LF or CR; '#' begins a
// comment.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"

namespace straytrace {

struct Token {
  std::string_view text;
  std::uint32_t line = 0, column = 0;  // from 1; line 0: the end of the file
};
struct TextLine {
  std::string_view text;  // without comment and line end
  std::uint32_t number = 0;
};
std::vector<TextLine> lines_of(std::string_view text);
std::vector<Token> words_of(TextLine const& line);

void complain(std::vector<Problem>&, Token const&, std::string what, std::string suggestion);

// Reads words one after the other. What does not fit is a problem, and `sound` is false from then on.
class TokenReader {
 public:
  TokenReader(std::string_view text, std::vector<Problem>& problems);

  bool done() const { return at_ == tokens_.size(); }
  Token peek() const { return done() ? Token{} : tokens_[at_]; }
  Token next();
  bool is_next(std::string_view word) const { return !done() && tokens_[at_].text == word; }
  std::vector<Token> rest_of_line(Token const& first);  // what follows `first` in its line
  std::size_t words_left_in_line(Token const& first) const;
  double number(std::string const& what);
  std::vector<double> numbers(std::size_t count, std::string const& what);
  void refuse(Token const&, std::string what, std::string suggestion);

  bool sound = true;

 private:
  std::vector<Problem>& problems_;
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
};

// "'ten' is not a number", and what to write.
void complain_of_number(std::vector<Problem>&, Token const&, std::string const& what);

}  // namespace straytrace
