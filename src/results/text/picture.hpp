// SPDX-License-Identifier: BSD-3-Clause
// Pictures: arrays of colours as files, and plots that the Python side draws in a child process.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::results {

// The picture of a run, drawn by the Python side in a child process.

// Pictures as PNG files.

struct Image {
  std::uint32_t columns = 0, rows = 0;
  std::vector<std::uint8_t> rgb;  // three bytes per pixel, row by row from the upper left, sRGB
};

std::string png_bytes(Image const&);  // throws NumericalError when libpng fails
// Complete or not at all; throws InputError with the reason of the system.
void write_png(std::string const& file, Image const&);

// Scale of a picture whose colours represent a number.

struct ColourBar {
  double low = 0, high = 0;  // ends, above 0; logarithmic between
  std::string title;         // name of the number, with its unit: lower case, digits and :+-./
  std::function<std::array<std::uint8_t, 3>(double)> colour;  // of 0 (low) to 1 (high)
};

// Adds it below the picture, with labelled decades; false: the picture is too narrow and unchanged.
bool add_colour_bar(Image&, ColourBar const&);

struct RunContent;

// Draws `png_file` from `run_file`; band of the shares in Hz, the whole grid when high <= low; `measured`: strain over
// it, JSON of session/records/route_predictions.hpp. False, and `message`
// explains what happened and what to install, on failure. Interpreter: STRAYTRACE_PYTHON, /usr/bin/python3, python3 in
// PATH. Folder of the package: STRAYTRACE_PYTHONPATH, then python/ or share/straytrace/python/ in a folder above the
// program.
bool draw_picture(std::string const& run_file, std::string const& png_file, std::string& message, double low_hz = 0,
                  double high_hz = 0, std::string const& measured = "");
// Its bytes as SVG; empty, and `message`, when it cannot.
std::string svg_of_run(std::string const& run_file, std::string& message, std::string const& measured = "");

// Maps of all receivers of a run, one picture each, into a folder; `one_of_them` must be there afterwards.
bool draw_map_pictures(std::string const& run_file, std::string const& folder, std::string const& one_of_them,
                       std::string& message);

// The field of the cavity of a run.
bool draw_wave_picture(RunContent const&, std::string const& png_file, std::string& message);

// Draws from a JSON file of this program with the module straytrace.plots.WHAT: "law" and "scatter" from `straytrace
// inspect`, "budget", "scan" and "ghosts" from the commands of that name, "curves" from results/curves/curve_file.hpp.
bool draw_from_json(std::string const& what, std::string const& json_file, std::string const& png_file,
                    std::string& message);
// The bytes of this picture or page from `json`, drawn in a temporary folder; empty, and `message`, on failure.
std::string picture_of(std::string const& json, std::string const& what, std::string& message,
                       std::string const& ending = ".png");

}  // namespace straytrace::results
