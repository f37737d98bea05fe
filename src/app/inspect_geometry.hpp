// SPDX-License-Identifier: BSD-3-Clause
// What a CAD or mesh file contains, as understood.
#pragma once

#include <string>

#include "app/options.hpp"

namespace straytrace {

bool is_geometry(std::string const& file);  // by its ending
// Prints parts, colours, faces, areas, size, findings and an entry for a scene. `units`: of the numbers in the file, in
// place of what it says; empty: as it says. `plot`: a PNG file, none when empty.
int inspect_geometry(std::string const& file, std::string const& units, std::string const& plot, Options const&);

}  // namespace straytrace
