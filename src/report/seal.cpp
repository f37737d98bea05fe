// SPDX-License-Identifier: BSD-3-Clause
#include "report/seal.hpp"

#include <fmt/format.h>

#include "base/message.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

constexpr std::size_t block = 512;  // smallest user block of HDF5
constexpr std::string_view mark = "straytrace-run sha256 ";
constexpr std::string_view hdf5_mark = "\x89HDF\r\n\x1a\n";

}  // namespace

std::string sealed(std::string const& hdf5_image) {
  std::string bytes = fmt::format("{}{} bytes {}\n", mark, sha256(hdf5_image), hdf5_image.size());
  bytes.resize(block, '\0');
  return bytes + hdf5_image;
}

std::string unsealed(std::string bytes, std::string const& name) {
  if (!bytes.starts_with(mark)) {
    char const* what = bytes.empty()                  ? "the file is empty"
                       : bytes.starts_with(hdf5_mark) ? "it is an HDF5 file of another program"
                                                      : "its first bytes are not those of a run file";
    throw InputError(fmt::format("'{}' is not a straytrace run file: {}", name, what));
  }
  std::string const line = bytes.substr(0, bytes.find('\n'));
  if (bytes.size() > block) {
    bytes.erase(0, block);
    if (line == fmt::format("{}{} bytes {}", mark, sha256(bytes), bytes.size())) return bytes;
  }
  throw InputError(
      fmt::format("'{}' is damaged: its content does not match its checksum. It was cut short in a copy, "
                  "or changed by another program; copy it again, or make the run again",
                  name));
}

}  // namespace straytrace
