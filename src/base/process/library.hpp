// SPDX-License-Identifier: BSD-3-Clause
// Shared libraries that the program loads on request.
#pragma once

#include <filesystem>
#include <string>

#include "base/namespaces.hpp"

namespace straytrace {

// By which this program is started: its own file; of packages that bring their own loader, the starter next to that.
std::filesystem::path program_file();

// One of this build: in the folder of the program or in ../lib/straytrace. Empty: there is none.
std::string installed_library(std::string const& name);

// A symbol of a library, which is never unloaded: objects of its classes may outlive the loader. InputError with this
// remedy if the library cannot be loaded or has no such symbol.
void* library_symbol(std::string const& library, std::string const& symbol, std::string const& remedy);

}  // namespace straytrace
