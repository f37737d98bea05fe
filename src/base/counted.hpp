// SPDX-License-Identifier: BSD-3-Clause
// Counts with their noun: "1 route", "2 routes".
#pragma once

#include <concepts>
#include <string>

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

}  // namespace straytrace
