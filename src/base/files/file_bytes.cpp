// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/file_bytes.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <stdexcept>
#include <unistd.h>

namespace straytrace {
namespace {

class OpenFile {
 public:
  explicit OpenFile(std::filesystem::path const& file)  // O_NONBLOCK: a pipe without a writer is opened at once
      : descriptor_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
    struct stat about = {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &about) != 0)
      why_ = errno == ENOENT ? "there is no such file" : std::strerror(errno);
    else if (!S_ISREG(about.st_mode))
      why_ = "it is not a regular file";
    size_ = std::size_t(std::max<off_t>(about.st_size, 0));
  }
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(OpenFile const&) = delete;
  OpenFile& operator=(OpenFile const&) = delete;

  std::string const& why() const { return why_; }
  std::size_t stated_size() const { return size_; }
  // Up to `count` bytes; fewer at the end of the file, or when why() says that they cannot be read.
  std::size_t read(char* to, std::size_t count) {
    std::size_t done = 0;
    while (done < count) {
      ssize_t const got = ::read(descriptor_, to + done, count - done);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) why_ = std::strerror(errno);
      if (got <= 0) break;
      done += std::size_t(got);
    }
    return done;
  }

 private:
  int descriptor_;
  std::size_t size_ = 0;
  std::string why_;
};

// Files of the system state no size, and others may grow: one byte more is asked for than there should be.
std::string all_of(OpenFile& file, std::size_t limit) {
  std::string bytes;
  std::size_t wanted = std::min(file.stated_size(), limit) + 1, held = 0;
  for (;; wanted = std::min(2 * wanted + 4096, limit + 1)) {
    bytes.resize(wanted);
    held += file.read(bytes.data() + held, wanted - held);
    if (held < wanted || held > limit) break;
  }
  bytes.resize(held);
  return bytes;
}

}  // namespace

FileBytes bytes_of_file(std::filesystem::path const& name, std::size_t limit) try {
  limit = std::min(limit, std::size_t{1} << 62);
  OpenFile file(name);
  if (!file.why().empty()) return {"", file.why()};
  std::string const too_large = fmt::format("it is larger than {} MB", limit >> 20);
  if (file.stated_size() > limit) return {"", too_large};
  std::string bytes = all_of(file, limit);
  if (!file.why().empty()) return {"", file.why()};
  if (bytes.size() > limit) return {"", too_large};
  return {std::move(bytes), ""};
} catch (std::bad_alloc const&) {
  return {"", "it is larger than the memory"};
} catch (std::length_error const&) {
  return {"", "it is larger than the memory"};
}

std::string head_of_file(std::filesystem::path const& name, std::size_t count) {
  OpenFile file(name);
  if (!file.why().empty()) return "";
  std::string bytes(count, '\0');
  bytes.resize(file.read(bytes.data(), count));
  return bytes;
}

}  // namespace straytrace
