// SPDX-License-Identifier: BSD-3-Clause
// A file that is written piece by piece and appears complete or not at all.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace straytrace {

// It grows next to its destination and is removed again unless published. Throws InputError when it cannot be written.
class GrowingFile {
 public:
  explicit GrowingFile(std::string const& destination);
  ~GrowingFile();
  GrowingFile(GrowingFile const&) = delete;
  GrowingFile& operator=(GrowingFile const&) = delete;

  void write(std::string_view bytes);
  void publish();

 private:
  static constexpr std::size_t buffered = 1 << 20;  // bytes
  void flush();
  void give_name();
  std::string destination_, buffer_;
  std::string name_;  // beside the destination; empty as long as the file has none
  int descriptor_ = -1;
};

}  // namespace straytrace
