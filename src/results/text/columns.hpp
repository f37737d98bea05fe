// SPDX-License-Identifier: BSD-3-Clause
// Aligned columns of UTF-8 text.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::results {

struct Columns {
  std::vector<std::string> titles;
  std::vector<bool> left;                      // alignment; missing entries: right
  std::vector<std::vector<std::string>> rows;  // an empty row: a rule
};

std::string aligned(Columns const&, std::string const& indent = "");
std::size_t width_of(std::string const& utf8);  // code points

// Common parts of all text exports.

std::string file_header(RunContent const&);                  // "# " lines: title, program, model, seed
std::string hash_text(std::uint64_t);                        // 16 hexadecimal digits
std::string csv_text(std::string const&);                    // quoted where it must be
std::string reverse_words(bool reverse_routes);              // "C_rev on: ..."
std::string csv_number(bool known, double value);            // all digits; nan when not known
std::string finite_text(double, std::string const& format);  // "-" unless finite

}  // namespace straytrace::results
