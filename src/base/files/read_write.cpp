// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/read_write.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <stdexcept>
#include <system_error>
#include <unistd.h>
#include <vector>

#include "base/errors.hpp"
#include "base/input/table.hpp"

namespace straytrace {
namespace {

namespace fs = std::filesystem;

class OpenFile {
 public:
  explicit OpenFile(fs::path const& file)  // O_NONBLOCK: a pipe without a writer is opened at once
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
  // Up to `count` bytes; fewer at the end of the file, or after an error, which why() then names.
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

// Files of /proc state no size, and others may grow: always ask for one byte more than expected.
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

[[noreturn]] void refuse_to_write(std::string const& file, std::string const& why) {
  throw InputError(fmt::format("cannot write '{}': {}", file, why),
                   "choose another place, free disk space, or check permissions");
}
[[noreturn]] void refuse_to_write(std::string const& file) { refuse_to_write(file, std::strerror(errno)); }

// Target of a link, so that writing replaces the target and not the link.
fs::path behind_links(fs::path name) {
  std::error_code no_link;
  while (fs::is_symlink(name, no_link)) name = name.parent_path() / fs::read_symlink(name, no_link);
  return name;
}

// In the folder of the destination; shortened to a length that file systems accept.
std::string temporary_name(fs::path const& destination) {
  return (destination.parent_path() / destination.filename().string().substr(0, 200)).string() + ".part-";
}

}  // namespace

FileBytes bytes_of_file(fs::path const& name, std::size_t limit) try {
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

std::string nearest_file(fs::path const& file) {
  constexpr std::size_t most = 1000;
  std::error_code failed, unknown;
  std::vector<std::string> names;
  fs::path const folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end && names.size() < most;
       at.increment(failed))
    if (at->is_regular_file(unknown)) names.push_back(at->path().filename().string());
  std::sort(names.begin(), names.end());
  return nearest_word(file.filename().string(), names);
}

std::string remedy_for_unreadable(fs::path const& file) {
  std::string const otherwise = "check the name and the folder";
  std::error_code failed;
  if (fs::is_regular_file(file / "run.h5", failed))
    return fmt::format("name the run in this folder: '{}'", (file / "run.h5").string());
  if (fs::exists(file, failed)) return otherwise;
  std::string const near = nearest_file(file);
  return near.empty() ? otherwise : fmt::format("did you mean '{}'?", (file.parent_path() / near).string());
}

std::string head_of_file(fs::path const& name, std::size_t count) {
  OpenFile file(name);
  if (!file.why().empty()) return "";
  std::string bytes(count, '\0');
  bytes.resize(file.read(bytes.data(), count));
  return bytes;
}

// A file without a name where the system supports it (O_TMPFILE): a killed program leaves nothing behind. Only regular
// files may be replaced: as root, a rename would replace a device by a file.
AtomicFile::AtomicFile(std::string const& destination) : destination_(destination) {
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
  name_ = temporary_name(destination_) + "XXXXXX";
  descriptor_ = ::mkostemp(name_.data(), O_CLOEXEC);
  if (descriptor_ < 0) name_.clear();
  mode_t const mask = ::umask(0);
  ::umask(mask);
  if (descriptor_ < 0 || ::fchmod(descriptor_, 0666 & ~mask) != 0) refuse_to_write(destination_);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!name_.empty()) ::unlink(name_.c_str());
}

namespace {

// False: the system refuses; errno says why.
bool written(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    ssize_t const done = ::write(descriptor, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return false;
    bytes.remove_prefix(std::size_t(done));
  }
  return true;
}

}  // namespace

void AtomicFile::write(std::string_view bytes) {
  if (bytes.size() < buffered) {
    buffer_ += bytes;
    if (buffer_.size() >= buffered) flush();
    return;
  }
  flush();
  if (!written(descriptor_, bytes)) refuse_to_write(destination_);
}

void AtomicFile::flush() {
  if (!written(descriptor_, buffer_)) refuse_to_write(destination_);
  buffer_.clear();
}

void AtomicFile::publish() {
  flush();
  if (::fsync(descriptor_) != 0) refuse_to_write(destination_);
  if (name_.empty()) give_name();
  int const closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0 || std::rename(name_.c_str(), destination_.c_str()) != 0) refuse_to_write(destination_);
  name_.clear();
}

// Only a named file can be renamed over an earlier one.
void AtomicFile::give_name() {
  std::string const here = fmt::format("/proc/self/fd/{}", descriptor_);
  for (int i = 0;; ++i) {
    std::string const name = fmt::format("{}{}-{}", temporary_name(destination_), ::getpid(), i);
    if (::linkat(AT_FDCWD, here.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      name_ = name;
      return;
    }
    if (errno != EEXIST || i == 1000) refuse_to_write(destination_);
  }
}

void check_writable(std::string const& file) {
  if (std::error_code none; fs::is_directory(file, none))
    throw InputError(fmt::format("the output '{}' is a folder", file), "name a file");
  fs::path const folder = fs::path(file).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
    throw InputError(fmt::format("there is no folder '{}' to write to", folder.string()),
                     "create it first, or choose another one");
  AtomicFile const probe(file);
}

InputError errors_in(std::string const& file, std::vector<Problem> problems) {
  std::string text;
  for (Problem const& p : problems) text += (text.empty() ? "" : "\n") + placed_message(p, file);
  return {std::move(problems), std::move(text), {file}};
}

bool is_binary(std::string_view bytes) {
  std::string_view const start = bytes.substr(0, 4096);
  auto const controls = std::count_if(start.begin(), start.end(), [](char c) {
    auto const byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && (byte < '\t' || byte > '\r')) || byte == 0x7f;
  });
  return start.find('\0') != start.npos || std::size_t(controls) * 10 > start.size();
}

Problem binary_problem(std::string_view bytes, std::uint32_t file) {
  if (bytes.starts_with("straytrace-run "))
    return {{file},
            "this is a run file, but a text file is needed here",
            "name the text file; straytrace paths, noise and report read run files"};
  return {{file}, "this is a binary file, but a text file is needed here", "name a text file, or export it as text"};
}

void refuse_binary(std::string_view bytes, std::string const& file) {
  if (is_binary(bytes)) throw errors_in(file, {binary_problem(bytes)});
}

std::string read_text(std::string const& file) {
  FileBytes read = bytes_of_file(file);
  if (!read.why.empty())
    throw InputError(fmt::format("cannot read '{}': {}", file, read.why), remedy_for_unreadable(file));
  refuse_binary(read.bytes, file);
  return std::move(read.bytes);
}

namespace {

void check(int ok) {
  if (ok != 1) throw NumericalError("sha256 is not available in this OpenSSL");
}

EVP_MD_CTX* digest(std::shared_ptr<void> const& context) { return static_cast<EVP_MD_CTX*>(context.get()); }

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new(), [](void* c) { EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(c)); }) {
  check(EVP_DigestInit_ex(digest(context_), EVP_sha256(), nullptr));
}

void Sha256::add(std::string_view bytes) { check(EVP_DigestUpdate(digest(context_), bytes.data(), bytes.size())); }

void Sha256::add_counted(std::string_view bytes) {
  add(fmt::format("{}:", bytes.size()));
  add(bytes);
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes = {};
  unsigned length = 0;
  check(EVP_DigestFinal_ex(digest(context_), bytes.data(), &length));
  std::string text;
  for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", bytes[i]);
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.hex();
}

}  // namespace straytrace
