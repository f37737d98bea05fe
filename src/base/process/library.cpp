// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/library.hpp"

#include <fmt/format.h>

#include <dlfcn.h>
#include <filesystem>

#include "base/errors.hpp"

namespace straytrace {

std::filesystem::path program_file() {
  std::error_code ignored;
  std::filesystem::path const running = std::filesystem::read_symlink("/proc/self/exe", ignored);
  bool const by_loader = running.filename().string().starts_with("ld-linux");
  return by_loader ? running.parent_path() / "straytrace" : running;
}

std::string installed_library(std::string const& name) {
  std::error_code ignored;
  std::filesystem::path const program = program_file().parent_path();
  for (auto const& place : {program / name, program / ".." / "lib" / "straytrace" / name})
    if (std::filesystem::exists(place, ignored)) return place.lexically_normal().string();
  return {};
}

void* library_symbol(std::string const& library, std::string const& symbol, std::string const& remedy) {
  void* const loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!loaded) throw InputError(dlerror(), remedy);
  void* const found = dlsym(loaded, symbol.c_str());
  if (!found) throw InputError(fmt::format("'{}' is not an engine of straytrace", library), remedy);
  return found;
}

}  // namespace straytrace
