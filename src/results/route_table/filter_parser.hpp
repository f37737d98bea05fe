// SPDX-License-Identifier: BSD-3-Clause
// The grammar of filters of path tables.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/words.hpp"
#include "results/route_table/route_filter.hpp"

namespace straytrace {

using RouteTest = std::function<bool(std::size_t row)>;  // refers to the columns it was made for

struct ParsedFilter {
  RouteTest test;                       // empty where there are problems that end the reading
  RouteColumn const* column = nullptr;  // of parse_column()
  std::vector<FilterProblem> problems;
  std::vector<std::string> notes;
};

ParsedFilter parse_filter(std::string_view text, RouteColumns&);
ParsedFilter parse_column(std::string_view key, RouteColumns&);

// Words of a filter with their places.

using FilterUnits = std::vector<std::pair<std::string, double>>;  // name and factor

struct FilterWord {
  enum class Kind : std::uint8_t { name, number, quoted, sign, stray, end };
  Kind kind = Kind::end;
  std::string text;  // as written; of quoted ones what stands inside
  std::size_t begin = 0, width = 1;
};

class FilterWords {
 public:
  explicit FilterWords(std::string_view text) : text_(text) { read(); }

  FilterWord const& here() const { return here_; }
  FilterWord next();               // that which stood here
  bool takes(std::string_view w);  // any case; goes on if so
  // The longest of `units` that stands right behind the number just taken; empty: none.
  std::string unit(FilterUnits const& units);

 private:
  void read();

  std::string_view text_;
  std::size_t at_ = 0;
  FilterWord here_;
};

std::string joined(std::vector<std::string> const& words);  // "a, b"
std::string names_of(FilterUnits const&);
double factor_of(std::string const& name, FilterUnits const&);  // 1 where it is none of them
FilterUnits hertz();

}  // namespace straytrace
