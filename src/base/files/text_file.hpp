// SPDX-License-Identifier: BSD-3-Clause
// Text files of the user, and their problems. Readers reject binary files without printing their bytes.
#pragma once

#include <string>
#include <string_view>

#include "base/errors.hpp"

namespace straytrace {

// All problems of one file, a placed_message() each.
InputError errors_in(std::string const& file, std::vector<Problem>);

bool is_binary(std::string_view bytes);
Problem binary_problem(std::string_view bytes, std::uint32_t file = 0);
// Throws InputError for a binary file.
void refuse_binary(std::string_view bytes, std::string const& file);
// Throws InputError when the file cannot be read or is binary.
std::string read_text(std::string const& file);

}  // namespace straytrace
