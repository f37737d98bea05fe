// SPDX-License-Identifier: BSD-3-Clause
#include "base/text/words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace straytrace {
namespace {

constexpr std::size_t longest_line = 8000;  // bytes: two file names of maximum length fit in

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// U+0000 to U+001F, U+007F, and in two bytes U+0080 to U+009F.
bool controls(std::string_view text, std::size_t at) {
  auto const c = static_cast<unsigned char>(text[at]);
  if (c == 0xC2 && at + 1 < text.size()) return static_cast<unsigned char>(text[at + 1]) < 0xA0;
  return (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F;
}

// Of the UTF-8 sequence at a byte; 0: it is broken.
std::size_t bytes_of_letter(std::string_view text, std::size_t at) {
  auto const lead = static_cast<unsigned char>(text[at]);
  std::size_t const bytes = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  for (std::size_t i = 1; i < bytes; ++i)
    if (at + i >= text.size() || !continues(text[at + i])) return 0;
  return bytes;
}

// Bytes of a no-break or thin space at a byte between two digits.
std::size_t space_between_digits(std::string_view text, std::size_t at) {
  auto const digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  std::size_t const bytes = typeset_space(text.substr(at));
  return bytes > 0 && at > 0 && digit(at - 1) && digit(at + bytes) ? bytes : 0;
}

std::string printable_line(std::string_view line) {
  std::string out;
  for (std::size_t i = 0; i < line.size();) {
    if (out.size() >= longest_line) return out + " ...";
    std::size_t const bytes = bytes_of_letter(line, i);
    out += bytes == 0 || controls(line, i) ? "?" : line.substr(i, bytes);
    i += std::max<std::size_t>(bytes, 1);
  }
  return out;
}

}  // namespace

std::size_t typeset_space(std::string_view text) {
  for (std::string_view const space : {"\xc2\xa0", "\xe2\x80\x87", "\xe2\x80\x89", "\xe2\x80\xaf"})
    if (text.starts_with(space)) return space.size();
  return 0;
}

std::string with_plain_spaces(std::string_view text) {
  if (text.find_first_of("\xc2\xe2") == text.npos) return std::string(text);
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const bytes = typeset_space(text.substr(at)), step = std::max<std::size_t>(bytes, 1);
    bool const stays = bytes == 0 || space_between_digits(text, at) > 0;
    out += stays ? text.substr(at, step) : " ";
    at += step;
  }
  return out;
}

std::string space_in_number(std::string_view text) {
  for (std::size_t at = text.find_first_of("\xc2\xe2"); at < text.size(); ++at) {
    std::size_t const bytes = space_between_digits(text, at);
    if (bytes == 0) continue;
    unsigned point = static_cast<unsigned char>(text[at]) & (bytes == 2 ? 0x1fU : 0x0fU);
    for (std::size_t i = 1; i < bytes; ++i) point = point << 6 | (static_cast<unsigned char>(text[at + i]) & 0x3fU);
    return fmt::format("U+{:04X}", point);
  }
  return {};
}

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t at = 0;;) {
    std::size_t const end = std::min(text.find('\n', at), text.size());
    out += printable_line(text.substr(at, end - at));
    if (end == text.size()) return out;
    out += '\n';
    at = end + 1;
  }
}

bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, mark = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      mark = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++mark;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace straytrace
