// SPDX-License-Identifier: BSD-3-Clause
// Errors a user can cause (InputError, exit code 2) and failures of numerics (NumericalError, exit code 3).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/namespaces.hpp"

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

// "FILE:LINE:COLUMN: error: WHAT\n  SUGGESTION"; without the column or the line where they are 0.
std::string placed_message(Problem const&, std::string const& file);

// What is wrong with the input, and the remedy: one problem without a place (command line, unreadable run file), or all
// problems of all files at once. what() is the text to print.
class InputError : public std::exception {
 public:
  // "error: REASON\n  REMEDY". Without a remedy where the function that catches it adds one.
  explicit InputError(std::string reason, std::string remedy = "");
  InputError(std::vector<Problem> found, std::string text, std::vector<std::string> names = {})
      : problems(std::move(found)), files(std::move(names)), text_(std::move(text)) {}
  char const* what() const noexcept override { return text_.c_str(); }
  // The first problem, to be told with other words around it.
  std::string const& reason() const { return problems.front().what; }
  std::string const& remedy() const { return problems.front().suggestion; }

  std::vector<Problem> problems;
  std::vector<std::string> files;  // names by Place::file; empty when no problem has a place

 private:
  std::string text_;
};

// One that holds them all; at least one.
InputError joined(std::vector<InputError> const&);
// Nothing without errors, otherwise throws one InputError that holds them all.
void throw_all(std::vector<InputError> const&);
// Calls `action` and adds the InputError that it throws, if any.
template <class Action>
void collect(std::vector<InputError>& errors, Action const& action) {
  try {
    action();
  } catch (InputError const& e) {
    errors.push_back(e);
  }
}

// A JSON list of objects with file, line, column, width, severity, what, suggestion, for editors and scripts.
std::string problems_as_json(InputError const&);

class NumericalError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace straytrace
