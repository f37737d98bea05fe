// SPDX-License-Identifier: BSD-3-Clause
#include "base/errors.hpp"

#include <fmt/format.h>

namespace straytrace {
namespace {

std::string json_string(std::string const& text) {
  std::string out = "\"";
  for (char const c : text) {
    auto const byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\u{:04x}", byte);
    else
      out += c;
  }
  return out + '"';
}

}  // namespace

std::string problems_as_json(InputError const& error) {
  if (error.problems.empty())
    return fmt::format("[{{\"severity\": \"error\", \"what\": {}}}]\n", json_string(error.what()));
  std::string out = "[";
  for (Problem const& p : error.problems) {
    std::string const file = p.place.file < error.files.size() ? error.files[p.place.file] : std::string();
    out += fmt::format(
        "{}\n  {{\"file\": {}, \"line\": {}, \"column\": {}, \"width\": {}, \"end_column\": {}, \"severity\": \"{}\", "
        "\"what\": {}, "
        "\"suggestion\": {}}}",
        out.size() > 1 ? "," : "", json_string(file), p.place.line, p.place.column, p.width, p.place.column + p.width,
        p.severity == Severity::error ? "error" : "warning", json_string(p.what), json_string(p.suggestion));
  }
  return out + "\n]\n";
}

}  // namespace straytrace
