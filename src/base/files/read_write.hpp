// SPDX-License-Identifier: BSD-3-Clause
// Files: the only functions that read files of the user, files that appear complete or not at all, files that are part
// of the program, and checksums.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/errors.hpp"
#include "base/namespaces.hpp"

namespace straytrace {

// The only functions that read files of the user, and a file that appears complete or not at all.

struct FileBytes {
  std::string bytes;
  std::string why;  // reason for a failure: "there is no such file", "it is not a regular file"; empty: success
};

// Reads regular files only, opened for reading alone: pipes and devices may block or never end.
constexpr std::size_t any_size = std::size_t(-1);
FileBytes bytes_of_file(std::filesystem::path const&, std::size_t limit = any_size);

// The name of the file in the same folder whose name is nearest; empty when none is near.
std::string nearest_file(std::filesystem::path const&);

// What to do about a file that cannot be read: name the run.h5 of a folder, or the file beside it with the nearest
// name.
std::string remedy_for_unreadable(std::filesystem::path const&);

// The first `count` bytes or fewer; empty when the file cannot be read.
std::string head_of_file(std::filesystem::path const&, std::size_t count);

// Writes a temporary file next to the destination, removed again unless published. Throws InputError when it cannot
// write.
class AtomicFile {
 public:
  explicit AtomicFile(std::string const& destination);
  ~AtomicFile();
  AtomicFile(AtomicFile const&) = delete;
  AtomicFile& operator=(AtomicFile const&) = delete;

  void write(std::string_view bytes);
  void publish();

 private:
  static constexpr std::size_t buffered = 1 << 20;  // bytes
  void flush();
  void give_name();
  std::string destination_, buffer_;
  std::string name_;  // of the temporary file; empty while it has none (O_TMPFILE)
  int descriptor_ = -1;
};

// Throws InputError where no file of this name can be written, for a refusal before the work; leaves nothing behind.
void check_writable(std::string const& file);

// Text files of the user, and their problems. Readers reject binary files without printing their bytes.

// All problems of one file, a placed_message() each.
InputError errors_in(std::string const& file, std::vector<Problem>);

bool is_binary(std::string_view bytes);
Problem binary_problem(std::string_view bytes, std::uint32_t file = 0);
// Throws InputError for a binary file.
void refuse_binary(std::string_view bytes, std::string const& file);
// Throws InputError when the file cannot be read or is binary.
std::string read_text(std::string const& file);

// SHA-256 of contents, to recognise them.

class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  // With the length in front, so that two different lists of texts never give the same bytes.
  void add_counted(std::string_view bytes);
  std::string hex();  // 64 hexadecimal digits; call once, last

 private:
  std::shared_ptr<void> context_;
};

std::string sha256(std::string_view bytes);

// The files of the folders data/ and library/, compiled in, so that the program does not depend on where it is
// installed.

struct EmbeddedFile {
  std::string_view name, text;  // "curves/et-d.txt", "library/arm.yaml"
};
std::span<EmbeddedFile const> embedded_files();         // by name
std::string_view embedded_file(std::string_view name);  // text of a file; empty: no such file

}  // namespace straytrace
