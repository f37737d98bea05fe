// SPDX-License-Identifier: BSD-3-Clause
// Words in messages and texts: counts with their noun ("1 route", "2 routes"), lower case, spaces, printable text.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {

template <std::integral Count>
std::string counted(Count n, std::string const& noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}
// "1 route is", "2 routes are".
template <std::integral Count>
std::string counted(Count n, std::string const& noun, std::string const& verb_of_one, std::string const& verb_of_many) {
  return counted(n, noun) + " " + (n == 1 ? verb_of_one : verb_of_many);
}

// Converts A to Z, independent of the locale.
inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

// Whether `text` fits `pattern`, in which each * stands for any characters.
bool matches(std::string_view pattern, std::string_view text);

// Bytes of the no-break or thin space that a text begins with (U+00A0, U+2007, U+2009, U+202F); 0: of none.
std::size_t typeset_space(std::string_view text);
// With a plain space in place of each, so that the number of code points stays. Those between two digits stay: "1 000"
// is one number to a reader and two to a program.
std::string with_plain_spaces(std::string_view text);
std::string space_in_number(std::string_view text);  // "U+202F", the first between two digits; empty: there is none

// Escapes untrusted text for terminal output: control characters except line ends and tabs, and broken UTF-8, become
// '?'; lines are cut after 8000 bytes.
std::string printable(std::string_view text);

}  // namespace straytrace
