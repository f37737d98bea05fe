// SPDX-License-Identifier: BSD-3-Clause
#include "report/filter_words.hpp"

#include <algorithm>
#include <cctype>
#include <regex>

#include "base/form.hpp"
#include "base/quantity.hpp"

namespace straytrace {
namespace {

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::size_t bytes_of_letter(std::string_view text, std::size_t at) {
  std::size_t end = at + 1;
  while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
  return end - at;
}

}  // namespace

std::string joined(std::vector<std::string> const& words) {
  std::string text;
  for (std::string const& w : words) text += (text.empty() ? "" : ", ") + w;
  return text;
}

std::string names_of(FilterUnits const& units) {
  std::vector<std::string> names;
  for (auto const& u : units) names.push_back(u.first);
  return joined(names);
}

double factor_of(std::string const& name, FilterUnits const& units) {
  for (auto const& [unit, factor] : units)
    if (unit == name) return factor;
  return 1;
}

FilterUnits hertz() {
  FilterUnits units;
  for (char const* name : {"Hz", "kHz", "MHz", "mHz"}) units.emplace_back(name, parse_unit(name)->si);
  return units;
}

FilterWord FilterWords::next() {
  FilterWord const word = here_;
  if (word.kind != FilterWord::Kind::end) read();
  return word;
}

bool FilterWords::takes(std::string_view w) {
  if (here_.kind == FilterWord::Kind::quoted || lower_case(here_.text) != w) return false;
  read();
  return true;
}

std::string FilterWords::unit(FilterUnits const& units) {
  std::string longest;
  std::size_t const begin = here_.begin;
  for (auto const& [name, factor] : units) {
    std::size_t const end = begin + name.size();
    bool const ends = end >= text_.size() || !is_name(name.back()) || !is_name(text_[end]);
    if (name.size() > longest.size() && text_.substr(begin, name.size()) == name && ends) longest = name;
  }
  if (longest.empty()) return longest;
  at_ = begin + longest.size();
  read();
  return longest;
}

void FilterWords::read() {
  static std::regex const number(R"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)");
  using Kind = FilterWord::Kind;
  while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  std::size_t const begin = at_;
  here_ = {Kind::end, "", begin, 1};
  if (begin >= text_.size()) return;
  std::string_view const rest = text_.substr(begin);
  char const c = rest[0];
  std::match_results<std::string_view::const_iterator> hit;
  std::size_t width = 1;
  Kind kind = Kind::sign;
  if (c == '"' || c == '\'') {
    std::size_t const close = rest.find(c, 1);
    kind = close == std::string_view::npos ? Kind::stray : Kind::quoted;
    width = kind == Kind::quoted ? close + 1 : 1;
  } else if (std::regex_search(rest.begin(), rest.begin() + std::ptrdiff_t(std::min(rest.size(), longest_form)), hit,
                               number, std::regex_constants::match_continuous)) {
    kind = Kind::number;
    width = std::size_t(hit.length());
  } else if (is_name(c)) {
    kind = Kind::name;
    while (width < rest.size() && is_name(rest[width])) ++width;
  } else if (rest.starts_with("==") || rest.starts_with("!=") || rest.starts_with("<=") || rest.starts_with(">=")) {
    width = 2;
  } else if (std::string_view("<>(),").find(c) == std::string_view::npos) {
    kind = Kind::stray;
    width = bytes_of_letter(rest, 0);
  }
  std::size_t const inset = kind == Kind::quoted;
  here_ = {kind, std::string(rest.substr(inset, width - 2 * inset)), begin, width};
  at_ = begin + width;
}

}  // namespace straytrace
