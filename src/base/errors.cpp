// SPDX-License-Identifier: BSD-3-Clause
#include "base/errors.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/text/json_text.hpp"

namespace straytrace {

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
  if (!errors.empty()) throw joined(errors);
}

InputError joined(std::vector<InputError> const& errors) {
  if (errors.size() == 1) return errors.front();
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
  return {std::move(problems), std::move(text), std::move(files)};
}

std::string problems_as_json(InputError const& error) {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (Problem const& p : error.problems)
    list.push_back({{"file", p.place.file < error.files.size() ? error.files[p.place.file] : std::string()},
                    {"line", p.place.line},
                    {"column", p.place.column},
                    {"width", p.width},
                    {"end_column", p.place.column + p.width},
                    {"severity", p.severity == Severity::error ? "error" : "warning"},
                    {"what", p.what},
                    {"suggestion", p.suggestion}});
  return json_text(list, 1) + "\n";
}

}  // namespace straytrace
