// SPDX-License-Identifier: BSD-3-Clause
#include "scene/syntax_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace straytrace {
namespace {

struct Syntax {
  std::string_view complaint, what, suggestion;
};
constexpr std::array syntax{
    Syntax{"illegal flow end", "brackets of different kinds do not match", "close '[' with ']' and '{' with '}'"},
    Syntax{"illegal map value", "a second ': ' in one value",
           "put quotes around text that contains ': ', or begin a new line"},
    Syntax{"end of sequence not found", "the indentation does not fit the list above",
           "align the keys of one entry in one column"},
    Syntax{"end of map not found", "the indentation does not fit the table above",
           "align the keys of one table in one column"},
    Syntax{"bad file", "tables and lists are nested too deeply", "check the brackets"},  // the parser's own limit
};

// The innermost bracket left open in the lines before `last` (0: in the whole file). Quotes and comments are skipped
// the way YAML sees them: both begin only where a value may begin, brackets too unless one is open already.
std::optional<Place> unclosed_bracket(Source const& source, std::uint32_t file, std::uint32_t last) {
  struct Bracket {
    std::uint32_t line;
    std::size_t byte;
  };
  std::vector<Bracket> open;
  char quote = '\0';
  for (std::uint32_t number = 1; number <= source.lines.size() && (last == 0 || number < last); ++number) {
    std::string_view const line = source.line(number);
    bool starts = true;  // a value may begin here
    for (std::size_t i = 0; i < line.size(); ++i) {
      char const c = line[i];
      if (quote) {
        if (c == '\\' && quote == '"') ++i;
        if (c == quote) quote = '\0';
        continue;
      }
      if (c == '#' && (i == 0 || line[i - 1] == ' ')) break;
      if (c == ' ') continue;
      if (starts && (c == '"' || c == '\'')) quote = c;
      if ((c == '[' || c == '{') && (starts || !open.empty())) open.push_back({number, i});
      if ((c == ']' || c == '}') && !open.empty()) open.pop_back();
      starts = std::string_view("[{,:-").find(c) != std::string_view::npos;
    }
  }
  if (open.empty()) return {};
  auto const [number, byte] = open.back();
  return Place{file, number, code_points(source.line(number).substr(0, byte)) + 1};
}

}  // namespace

void report_syntax(SceneDocument& document, std::uint32_t file, std::vector<Problem> const& broken_lines,
                   SyntaxComplaint const& c) {
  Source const& source = document.source(file);
  std::uint32_t const number = static_cast<std::uint32_t>(std::max(0, c.line) + 1);
  bool const at_end = c.text.find("flow not found") != std::string::npos;  // its place is not where the cause is
  if (auto const open = unclosed_bracket(source, file, at_end ? 0 : number)) {
    document.add(
        {*open, "this bracket is not closed", "add ']' or '}' where it ends; look for a missing comma or quote too"});
    return;
  }
  for (Problem const& p : broken_lines) document.add(p);
  if (!broken_lines.empty()) return;
  auto const bytes = static_cast<std::size_t>(std::max(0, c.column));
  Place const place{file, number, code_points(source.line(number).substr(0, bytes)) + 1};
  auto const hit = std::find_if(syntax.begin(), syntax.end(), [&](Syntax const& s) { return s.complaint == c.text; });
  if (hit != syntax.end())
    document.add({place, std::string(hit->what), std::string(hit->suggestion)});
  else
    document.add({place, fmt::format("this is not valid YAML ({})", c.text),
                  "check indentation, brackets, quotes and ': ' near here"});
}

}  // namespace straytrace
