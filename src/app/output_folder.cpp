// SPDX-License-Identifier: BSD-3-Clause
#include "app/output_folder.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "base/message.hpp"

namespace straytrace {
namespace {

namespace fs = std::filesystem;

// Folders alone, and empty ones.
void remove_empty(std::vector<fs::path> const& folders) {
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) ::rmdir(folder->c_str());
}

// With its parents; returns why it was not made.
std::string make(fs::path const& folder, std::vector<fs::path>& made) {
  fs::path above;
  int error = 0;  // of the last part
  for (fs::path const& part : fs::absolute(folder)) {
    above /= part;
    error = ::mkdir(above.c_str(), 0777) == 0 ? 0 : errno;
    if (error == 0) made.push_back(above);
  }
  std::error_code code;
  if (fs::is_directory(folder, code)) return "";
  if (fs::is_symlink(folder, code)) return "a link has this name, and what it leads to is not there";
  return fs::exists(folder, code) ? "a file has this name" : std::strerror(error);
}

[[noreturn]] void refuse_folder(std::string const& verb, fs::path const& folder, std::string const& why) {
  throw InputError(
      fmt::format("error: cannot {} the folder '{}': {}\n  choose another one with -o", verb, folder.string(), why));
}

}  // namespace

OutputFolder::OutputFolder(std::string const& name, std::vector<std::string> const& files) : folder_(name) {
  if (std::string const why = make(folder_, made_); !why.empty()) {
    remove_empty(made_);
    refuse_folder("make", folder_, why);
  }
  if (::faccessat(AT_FDCWD, folder_.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    std::string const why = std::strerror(errno);
    remove_empty(made_);
    refuse_folder("write to", folder_, why);
  }
  std::error_code ignored;
  for (std::string const& file : files)
    if (fs::is_directory(folder_ / file, ignored))
      refuse_folder("write to", folder_, fmt::format("'{}' is a folder", file));
}

OutputFolder::~OutputFolder() { remove_empty(made_); }

}  // namespace straytrace
