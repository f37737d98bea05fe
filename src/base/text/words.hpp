// SPDX-License-Identifier: BSD-3-Clause
// Counts with their noun: "1 route", "2 routes".
#pragma once

#include <concepts>
#include <string>
#include <string_view>

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

// The letters A to Z of a text as a to z, everything else unchanged, whatever the locale.

inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

// Escapes untrusted text for terminal output.

// Control characters but line ends and tabs become '?', so that no text steers a terminal; of lines beyond 8000 bytes
// the rest is left out.
std::string printable(std::string_view text);

}  // namespace straytrace
