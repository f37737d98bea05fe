// SPDX-License-Identifier: BSD-3-Clause
// Other programs, started without a shell.
#pragma once

#include <string>
#include <vector>

namespace straytrace {

struct FinishedChild {
  int start_error = 0;  // errno, when the program could not be started
  int status = -1;      // exit status
  std::string output;   // both streams
};

// arguments[0] is the program, looked up in PATH when it names no folder; `variables`: "NAME=value". Its standard input
// is empty.
// What comes out of a pipe until nobody can write into it any more.
std::string read_all(int descriptor);
FinishedChild run_child(std::vector<std::string> arguments, std::vector<std::string> variables);

}  // namespace straytrace
