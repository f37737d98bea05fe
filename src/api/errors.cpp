// SPDX-License-Identifier: BSD-3-Clause
#include "api/errors.hpp"

#include "session/build_info.hpp"

namespace straytrace::api {

std::string version() { return build_info::version; }

InputError::InputError(std::string const& text, std::vector<Problem> found)
    : std::runtime_error(text), problems_(std::make_shared<std::vector<Problem> const>(std::move(found))) {}
InputError::~InputError() = default;
NumericalError::~NumericalError() = default;

InputError as_public(straytrace::InputError const& e) {
  std::vector<Problem> found;
  for (straytrace::Problem const& p : e.problems) {
    bool const placed = p.place.line > 0 && p.place.file < e.files.size();
    found.push_back({placed ? e.files[p.place.file] : "", p.place.line, p.place.column, p.severity == Severity::warning,
                     p.what, p.suggestion});
  }
  return {e.what(), std::move(found)};
}

}  // namespace straytrace::api
