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

std::string placed_message(Problem const& p, std::string const& file) {
  std::string place = file;
  if (p.place.line > 0) place += fmt::format(":{}", p.place.line);
  if (p.place.column > 0) place += fmt::format(":{}", p.place.column);
  return fmt::format("{}: error: {}\n  {}", place, p.what, p.suggestion);
}

InputError::InputError(std::string reason, std::string remedy)
    : text_("error: " + reason + (remedy.empty() ? "" : "\n  " + remedy)) {
  problems.push_back({{}, std::move(reason), std::move(remedy)});
}

void throw_all(std::vector<InputError> const& errors) {
  if (errors.empty()) return;
  if (errors.size() == 1) throw errors.front();
  std::vector<Problem> problems;
  std::vector<std::string> files{""};
  std::string text;
  for (InputError const& e : errors) {
    auto const first = e.files.empty() ? 0u : std::uint32_t(files.size());
    files.insert(files.end(), e.files.begin(), e.files.end());
    for (Problem p : e.problems) {
      p.place.file += first;
      problems.push_back(std::move(p));
    }
    text += (text.empty() ? "" : "\n") + std::string(e.what());
  }
  throw InputError(std::move(problems), std::move(text), std::move(files));
}

std::string problems_as_json(InputError const& error) {
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
