// SPDX-License-Identifier: BSD-3-Clause
// The picture of a run, drawn by the Python side in a child process.
#pragma once

#include <string>

namespace straytrace {

// Draws `png_file` from `run_file`; band of the shares in Hz, the whole grid when high <= low. False, and `message`
// says what happened and what to install, when it cannot. Interpreter: STRAYTRACE_PYTHON, /usr/bin/python3, python3 in
// PATH. Folder of the package: STRAYTRACE_PYTHONPATH, then python/ or share/straytrace/python/ in a folder above the
// program.
bool draw_picture(std::string const& run_file, std::string const& png_file, std::string& message, double low_hz = 0,
                  double high_hz = 0);

}  // namespace straytrace
