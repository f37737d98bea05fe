// SPDX-License-Identifier: BSD-3-Clause
// Forms of short texts. std::regex takes stack for every letter that it matches, and a text of some tens of thousands
// ends the program: nothing that long has a form.
#pragma once

#include <regex>
#include <string>

namespace straytrace {

inline constexpr std::size_t longest_form = 2000;  // bytes

inline bool bounded_regex_match(std::string const& text, std::smatch& parts, std::regex const& form) {
  return text.size() <= longest_form && std::regex_match(text, parts, form);
}

}  // namespace straytrace
