// SPDX-License-Identifier: BSD-3-Clause
// Pictures as PNG files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::results {

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

}  // namespace straytrace::results
