// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/files/read_write.hpp"

namespace straytrace {

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
    return {{file}, "this is a run file, but a text file is needed here", "see straytrace paths or straytrace report"};
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

}  // namespace straytrace
