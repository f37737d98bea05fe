// SPDX-License-Identifier: BSD-3-Clause
// Aligned columns of UTF-8 text.
#pragma once

#include <string>
#include <vector>

namespace straytrace {

struct Columns {
  std::vector<std::string> titles;
  std::vector<bool> left;                      // alignment; missing entries: right
  std::vector<std::vector<std::string>> rows;  // an empty row: a rule
};

std::string aligned(Columns const&, std::string const& indent = "");
std::size_t width_of(std::string const& utf8);  // code points

}  // namespace straytrace
