// SPDX-License-Identifier: BSD-3-Clause
// The picture of a run, drawn by the Python side in a child process.
#pragma once

#include <string>

#include "base/namespaces.hpp"

namespace straytrace::results {

// Draws `png_file` from `run_file`; band of the shares in Hz, the whole grid when high <= low. False, and `message`
// explains what happened and what to install, on failure. Interpreter: STRAYTRACE_PYTHON, /usr/bin/python3, python3 in
// PATH. Folder of the package: STRAYTRACE_PYTHONPATH, then python/ or share/straytrace/python/ in a folder above the
// program.
bool draw_picture(std::string const& run_file, std::string const& png_file, std::string& message, double low_hz = 0,
                  double high_hz = 0);
// Its bytes as SVG; empty, and `message`, when it cannot.
std::string svg_of_run(std::string const& run_file, std::string& message);

// Maps of all receivers of a run, one picture each, into a folder; `one_of_them` must be there afterwards.
bool draw_map_pictures(std::string const& run_file, std::string const& folder, std::string const& one_of_them,
                       std::string& message);

// The same for a BSDF model, from the JSON that `straytrace inspect --format json` prints.
bool draw_law_picture(std::string const& json_file, std::string const& png_file, std::string& message);
// Measured scatter with fits and residuals, from the same JSON of a file of measured scatter.
bool draw_scatter_picture(std::string const& json_file, std::string const& png_file, std::string& message);
// The same for a noise budget, from the JSON that `straytrace budget --format json` prints.
bool draw_budget_picture(std::string const& json_file, std::string const& png_file, std::string& message);

// Curves or a map, from the JSON of results/curves/curve_file.hpp.
bool draw_curves_picture(std::string const& json_file, std::string const& png_file, std::string& message);

// The bytes of one of these pictures from `json`, drawn in a temporary folder; empty, and `message`, on failure.
using DrawFromJson = bool (*)(std::string const& json_file, std::string const& png_file, std::string& message);
std::string picture_of(std::string const& json, DrawFromJson, std::string& message);

// Beam tree over the surfaces it meets, from the JSON of `straytrace ghosts -o`.
bool draw_ghost_picture(std::string const& json_file, std::string const& png_file, std::string& message);

// Requirement or ratio over the parameters of a scan, from the JSON of `straytrace scan`.
bool draw_scan_picture(std::string const& json_file, std::string const& png_file, std::string& message);

}  // namespace straytrace::results
