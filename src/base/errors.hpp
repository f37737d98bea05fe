// SPDX-License-Identifier: BSD-3-Clause
// Errors a user can cause (InputError, exit code 2) and failures of numerics (NumericalError, exit code 3).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace straytrace {

// A place in an input file, 1-based line and column; line 0: the file (or command line) as a whole.
struct Place {
  std::uint32_t file = 0, line = 0, column = 0;
};

enum class Severity : std::uint8_t { error, warning };

// One sentence with the error and its reason, and one with the remedy.
struct Problem {
  Place place;
  std::string what, suggestion;
  Severity severity = Severity::error;
  std::uint32_t width = 1;  // characters to underline
};

// All problems of all files at once; `text` is the rendered message, ready for stderr.
class InputError : public std::exception {
 public:
  InputError(std::vector<Problem> found, std::string text, std::vector<std::string> names = {})
      : problems(std::move(found)), files(std::move(names)), text_(std::move(text)) {}
  // For errors without a place in a file (command line, unreadable run file).
  explicit InputError(std::string text) : text_(std::move(text)) {}
  char const* what() const noexcept override { return text_.c_str(); }

  std::vector<Problem> problems;
  std::vector<std::string> files;  // names by Place::file

 private:
  std::string text_;
};

// A JSON list of objects with file, line, column, width, severity, what, suggestion, for editors and scripts.
std::string problems_as_json(InputError const&);

class NumericalError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace straytrace
