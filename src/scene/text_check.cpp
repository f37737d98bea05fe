// SPDX-License-Identifier: BSD-3-Clause
#include "scene/text_check.hpp"

#include <fmt/format.h>

namespace straytrace {
namespace {

// Length of the well-formed UTF-8 sequence at `at`; 0 when it is broken (overlong, surrogate, too large, cut off).
std::size_t sequence_length(std::string_view text, std::size_t at) {
  auto const byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  auto const tail = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
  unsigned const b = byte(at), second = byte(at + 1);
  if (b < 0x80) return 1;
  if (b >= 0xc2 && b <= 0xdf) return tail(at + 1) ? 2 : 0;
  if (b >= 0xe0 && b <= 0xef) {
    bool const bad = (b == 0xe0 && second < 0xa0) || (b == 0xed && second > 0x9f);
    return !bad && tail(at + 1) && tail(at + 2) ? 3 : 0;
  }
  if (b >= 0xf0 && b <= 0xf4) {
    bool const bad = (b == 0xf0 && second < 0x90) || (b == 0xf4 && second > 0x8f);
    return !bad && tail(at + 1) && tail(at + 2) && tail(at + 3) ? 4 : 0;
  }
  return 0;
}

// A directive stands before the first line of content.
void refuse_directives(SceneDocument& document, std::uint32_t file) {
  Source const& source = document.source(file);
  for (std::uint32_t number = 1; number <= source.lines.size(); ++number) {
    std::string_view const line = source.line(number);
    std::size_t const first = line.find_first_not_of(" \t");
    if (line.starts_with('%'))
      document.add({{file, number, 1}, "YAML directives are not part of the input language", "remove this line"});
    if (first != std::string_view::npos && line[first] != '#' && line[first] != '%') return;
  }
}

}  // namespace

std::optional<std::string> checked_text(SceneDocument& document, std::uint32_t file) {
  std::string text = document.source(file).text;
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (text.starts_with("straytrace-run")) {
    document.add({{file, 1, 1},
                  "this is a run file, not a scene",
                  "'straytrace run' makes it again, 'noise' and 'paths' read it"});
    return {};
  }
  std::uint32_t line = 1, column = 1;
  bool tab_in_line = false, readable = true;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const length = sequence_length(text, at);
    char const c = text[at];
    Place const here{file, line, column};
    if (length == 0) {
      document.add({here, "this is not UTF-8 text", "save the file as UTF-8"});
      return {};
    }
    if (c == '\t') {
      if (!tab_in_line) document.add({here, "a tab character", "use spaces; a tab looks different in every editor"});
      tab_in_line = true;
      text[at] = ' ';
    } else if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' &&
                !(c == '\r' && at + 1 < text.size() && text[at + 1] == '\n')) ||
               c == 0x7f) {
      document.add(
          {here, fmt::format("control character {:#04x} in the text", static_cast<unsigned char>(c)), "remove it"});
      readable = false;
    }
    at += length;
    ++column;
    if (c == '\n') {
      ++line;
      column = 1;
      tab_in_line = false;
    }
  }
  refuse_directives(document, file);
  if (!readable) return {};
  return text;
}

}  // namespace straytrace
