// SPDX-License-Identifier: BSD-3-Clause
// Files that appear complete or not at all.
#include "results/results.hpp"

#include <fmt/format.h>

#include <memory>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"

namespace straytrace {

void write_file(std::string const& file, std::string_view bytes) {
  AtomicFile temporary(file);
  temporary.write(bytes);
  temporary.publish();
}

void write_files(std::vector<std::pair<std::string, std::string>> const& files) {
  std::vector<std::unique_ptr<AtomicFile>> all;
  for (auto const& [file, bytes] : files) all.emplace_back(std::make_unique<AtomicFile>(file))->write(bytes);
  for (auto const& temporary : all) temporary->publish();
}

std::string read_file(std::string const& file) {
  FileBytes read = bytes_of_file(file);
  if (!read.why.empty()) throw InputError(fmt::format("cannot read '{}': {}", file, read.why));
  return std::move(read.bytes);
}

}  // namespace straytrace
