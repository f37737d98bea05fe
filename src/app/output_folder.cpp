// SPDX-License-Identifier: BSD-3-Clause
#include "app/output_folder.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "base/message.hpp"

namespace straytrace {
namespace {

namespace fs = std::filesystem;

void remove_empty(std::vector<fs::path> const& folders) {
  std::error_code not_empty;
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) fs::remove(*folder, not_empty);
}

[[noreturn]] void refuse_folder(std::string const& verb, fs::path const& folder, std::string const& why) {
  throw InputError(
      fmt::format("error: cannot {} the folder '{}': {}\n  choose another one with -o", verb, folder.string(), why));
}

}  // namespace

OutputFolder::OutputFolder(std::string const& name, std::vector<std::string> const& files) : folder_(name) {
  std::error_code code;
  for (fs::path p = fs::absolute(folder_).lexically_normal(); !p.empty() && !fs::exists(p, code); p = p.parent_path()) {
    if (p.has_filename()) made_.insert(made_.begin(), p);
    if (p == p.parent_path()) break;
  }
  fs::create_directories(folder_, code);
  std::error_code ignored;
  if (code || !fs::is_directory(folder_, ignored)) {
    remove_empty(made_);
    refuse_folder("make", folder_, code ? code.message() : "a file has this name");
  }
  if (::faccessat(AT_FDCWD, folder_.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    std::string const why = std::strerror(errno);
    remove_empty(made_);
    refuse_folder("write to", folder_, why);
  }
  for (std::string const& file : files)
    if (fs::is_directory(folder_ / file, ignored))
      refuse_folder("write to", folder_, fmt::format("'{}' is a folder", file));
}

OutputFolder::~OutputFolder() { remove_empty(made_); }

}  // namespace straytrace
