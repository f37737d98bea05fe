// SPDX-License-Identifier: BSD-3-Clause
// Warnings on stderr: sentences for people, JSON lists with --format json, nothing with --quiet.
#pragma once

#include <string>

#include "session/model.hpp"
#include "session/options.hpp"

namespace straytrace {

void print_warnings(Model const&, PrintOptions const&);
void print_warnings(Scene const&, PrintOptions const&);
void print_warning(std::string const& sentence, PrintOptions const&);  // without a place in a file

}  // namespace straytrace
