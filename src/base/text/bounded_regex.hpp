// SPDX-License-Identifier: BSD-3-Clause
// Regular expressions for short texts. std::regex recurses for every character and overflows the stack at some tens of
// thousands of them: longer texts never match.
#pragma once

#include <regex>
#include <string>

#include "base/namespaces.hpp"

namespace straytrace {

inline constexpr std::size_t longest_match = 2000;  // bytes

inline bool bounded_regex_match(std::string const& text, std::smatch& parts, std::regex const& form) {
  return text.size() <= longest_match && std::regex_match(text, parts, form);
}

}  // namespace straytrace
