// SPDX-License-Identifier: BSD-3-Clause
// Files that appear complete or not at all.
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <unistd.h>

#include "base/message.hpp"
#include "report/growing_file.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

[[noreturn]] void refuse(std::string const& verb, std::string const& file, int error) {
  throw InputError(fmt::format("cannot {} '{}': {}", verb, file, std::strerror(error)));
}

}  // namespace

GrowingFile::GrowingFile(std::string const& destination)
    : destination_(destination), name_(destination + ".part-XXXXXX") {
  descriptor_ = ::mkstemp(name_.data());
  if (descriptor_ < 0) refuse("write", destination_, errno);
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
    if (done < 0) refuse("write", destination_, errno);
    bytes.remove_prefix(std::size_t(done));
  }
  buffer_.clear();
}

void GrowingFile::publish() {
  flush();
  mode_t const mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(descriptor_, 0666 & ~mask) != 0 || ::fsync(descriptor_) != 0) refuse("write", destination_, errno);
  int const closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0 || std::rename(name_.c_str(), destination_.c_str()) != 0) refuse("write", destination_, errno);
  name_.clear();
}

void write_file(std::string const& file, std::string_view bytes) {
  GrowingFile temporary(file);
  temporary.write(bytes);
  temporary.publish();
}

void write_files(std::vector<std::pair<std::string, std::string>> const& files) {
  std::vector<std::unique_ptr<GrowingFile>> all;
  for (auto const& [file, bytes] : files) all.emplace_back(std::make_unique<GrowingFile>(file))->write(bytes);
  for (auto const& temporary : all) temporary->publish();
}

std::string read_file(std::string const& file) {
  struct stat about = {};
  if (::stat(file.c_str(), &about) != 0) refuse("read", file, errno);
  if (S_ISDIR(about.st_mode)) refuse("read", file, EISDIR);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(stream), {});
  if (!stream || stream.bad()) refuse("read", file, errno != 0 ? errno : EIO);
  return bytes;
}

}  // namespace straytrace
