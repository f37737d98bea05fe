// SPDX-License-Identifier: BSD-3-Clause
// The grammar of filters of path tables.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "report/route_filter.hpp"

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

}  // namespace straytrace
