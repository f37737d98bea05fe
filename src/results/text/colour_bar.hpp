// SPDX-License-Identifier: BSD-3-Clause
// Scale of a picture whose colours mean a number.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "results/text/png.hpp"

namespace straytrace {

struct ColourBar {
  double low = 0, high = 0;  // ends, above 0; logarithmic between
  std::string title;         // what the number is, with its unit: lower case, digits and :+-./
  std::function<std::array<std::uint8_t, 3>(double)> colour;  // of 0 (low) to 1 (high)
};

// Adds it below in rows of its own, with labelled decades; false: the picture is too narrow, and is as it was.
bool add_colour_bar(Image&, ColourBar const&);

}  // namespace straytrace
