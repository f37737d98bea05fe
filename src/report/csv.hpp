// SPDX-License-Identifier: BSD-3-Clause
// What all text exports share.
#pragma once

#include <string>

#include "report/report.hpp"

namespace straytrace {

std::string file_header(RunContent const&);        // "# " lines: title, program, model, seed
std::string hash_text(std::uint64_t);              // 16 hexadecimal digits
std::string csv_text(std::string const&);          // quoted where it must be
std::string reverse_words(bool reverse_routes);    // "C_rev on: ..."
std::string csv_number(bool known, double value);  // all digits; nan when not known

}  // namespace straytrace
