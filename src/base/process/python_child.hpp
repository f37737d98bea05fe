// SPDX-License-Identifier: BSD-3-Clause
// Modules of python/straytrace, run as programs.
#pragma once

#include <string>
#include <vector>

#include "base/process/child_process.hpp"

namespace straytrace {

// $STRAYTRACE_PYTHON, or else: `system` the Python of the system, which has Debian's packages; otherwise that of PATH,
// which an active environment of conda or venv replaces.
enum class PythonChoice : bool { path, system };

struct PythonChild : FinishedChild {
  std::string python;       // the interpreter
  bool has_package = true;  // false: the folder python/straytrace was not found, and nothing was started
};
// python -m words[0] words[1] ...
PythonChild run_python(std::vector<std::string> words, PythonChoice);

// A temporary folder, gone with the object. InputError where none can be made.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(std::string const& purpose);  // for the message: "the picture"
  ~TemporaryFolder();
  TemporaryFolder(TemporaryFolder const&) = delete;
  TemporaryFolder& operator=(TemporaryFolder const&) = delete;
  std::string path(std::string const& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
};

}  // namespace straytrace
