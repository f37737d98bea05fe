// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/growing_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <unistd.h>

#include "base/errors.hpp"

namespace straytrace {
namespace {

[[noreturn]] void refuse_to_write(std::string const& file, std::string const& why) {
  throw InputError(
      fmt::format("error: cannot write '{}': {}\n  choose another place, or make room or rights there", file, why));
}
[[noreturn]] void refuse_to_write(std::string const& file) { refuse_to_write(file, std::strerror(errno)); }

namespace fs = std::filesystem;

// Where a link leads, so that what it leads to is replaced and not the link.
fs::path behind_links(fs::path name) {
  std::error_code no_link;
  while (fs::is_symlink(name, no_link)) name = name.parent_path() / fs::read_symlink(name, no_link);
  return name;
}

// Beside the destination; short enough for a file system however long that is.
std::string beside(fs::path const& destination) {
  return (destination.parent_path() / destination.filename().string().substr(0, 200)).string() + ".part-";
}

}  // namespace

// A file without a name where the system has them: a program that is killed leaves nothing behind. Devices, which root
// could replace by a file, are refused.
GrowingFile::GrowingFile(std::string const& destination) : destination_(destination) {
  struct stat there = {};
  if (::stat(destination.c_str(), &there) == 0) {
    if (!S_ISREG(there.st_mode))
      refuse_to_write(destination, S_ISDIR(there.st_mode) ? std::strerror(EISDIR) : "it is not a regular file");
  } else if (errno != ENOENT) {
    refuse_to_write(destination);
  }
  destination_ = behind_links(destination);
  std::string const folder = fs::path(destination_).parent_path();
  bool const can_be_named = ::access("/proc/self/fd", X_OK) == 0;
  if (can_be_named) descriptor_ = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor_ >= 0) return;
  name_ = beside(destination_) + "XXXXXX";
  descriptor_ = ::mkostemp(name_.data(), O_CLOEXEC);
  if (descriptor_ < 0) name_.clear();
  mode_t const mask = ::umask(0);
  ::umask(mask);
  if (descriptor_ < 0 || ::fchmod(descriptor_, 0666 & ~mask) != 0) refuse_to_write(destination_);
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!name_.empty()) ::unlink(name_.c_str());
}

void GrowingFile::write(std::string_view bytes) {
  buffer_ += bytes;
  if (buffer_.size() >= buffered) flush();
}

void GrowingFile::flush() {
  std::string_view bytes = buffer_;
  while (!bytes.empty()) {
    ssize_t const done = ::write(descriptor_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) refuse_to_write(destination_);
    bytes.remove_prefix(std::size_t(done));
  }
  buffer_.clear();
}

void GrowingFile::publish() {
  flush();
  if (::fsync(descriptor_) != 0) refuse_to_write(destination_);
  if (name_.empty()) give_name();
  int const closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0 || std::rename(name_.c_str(), destination_.c_str()) != 0) refuse_to_write(destination_);
  name_.clear();
}

// Only a name can take the place of an earlier file.
void GrowingFile::give_name() {
  std::string const here = fmt::format("/proc/self/fd/{}", descriptor_);
  for (int i = 0;; ++i) {
    std::string const name = fmt::format("{}{}-{}", beside(destination_), ::getpid(), i);
    if (::linkat(AT_FDCWD, here.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      name_ = name;
      return;
    }
    if (errno != EEXIST || i == 1000) refuse_to_write(destination_);
  }
}

}  // namespace straytrace
