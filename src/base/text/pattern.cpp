// SPDX-License-Identifier: BSD-3-Clause
#include "base/text/pattern.hpp"

#include <algorithm>
#include <regex>

namespace straytrace {

struct Pattern::Form {
  std::regex regex;
};

Pattern::Pattern(std::string const& form) : form_(std::make_shared<Form>(Form{std::regex(form)})) {}

PatternMatch Pattern::match(std::string const& text) const {
  PatternMatch found;
  std::smatch parts;
  if (text.size() > longest || !std::regex_match(text, parts, form_->regex)) return found;
  for (std::size_t i = 0; i < parts.size(); ++i)
    found.groups_.push_back({parts[i].str(), parts[i].matched, std::size_t(parts.position(i))});
  return found;
}

std::size_t Pattern::width_at_start(std::string_view text) const {
  std::cmatch hit;
  char const *const begin = text.data(), *const end = begin + std::min(text.size(), longest);
  bool const found = std::regex_search(begin, end, hit, form_->regex, std::regex_constants::match_continuous);
  return found ? std::size_t(hit.length()) : 0;
}

std::string Pattern::replaced(std::string const& text, std::string const& with) const {
  return std::regex_replace(text, form_->regex, with);
}

}  // namespace straytrace
