// SPDX-License-Identifier: BSD-3-Clause
// Pictures as PNG files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace straytrace {

struct Image {
  std::uint32_t columns = 0, rows = 0;
  std::vector<std::uint8_t> rgb;  // three bytes per pixel, row by row from the upper left, sRGB
};

std::string png_bytes(Image const&);  // throws NumericalError when libpng fails
// Complete or not at all; throws InputError with the reason of the system.
void write_png(std::string const& file, Image const&);

}  // namespace straytrace
