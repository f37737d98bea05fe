// SPDX-License-Identifier: BSD-3-Clause
// The media that scenes know without stating them, each at a wavelength of the detectors that it holds for.
#pragma once

#include <string>
#include <vector>

namespace straytrace {

struct KnownMedium {
  std::string name, source;
  double index, wavelength;  // m, vacuum: 1064 nm, or 1550 nm where that is out of range
};
std::vector<KnownMedium> known_media();

}  // namespace straytrace
