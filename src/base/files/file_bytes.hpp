// SPDX-License-Identifier: BSD-3-Clause
// The one way by which files of the user are read. Only regular files are, opened for reading alone: pipes and devices
// may block for ever or never end.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace straytrace {

struct FileBytes {
  std::string bytes;
  std::string why;  // it was not read: "there is no such file", "it is not a regular file"; empty: it was
};

constexpr std::size_t any_size = std::size_t(-1);
FileBytes bytes_of_file(std::filesystem::path const&, std::size_t limit = any_size);

// Its first `count` bytes or fewer; nothing where it cannot be read.
std::string head_of_file(std::filesystem::path const&, std::size_t count);

}  // namespace straytrace
