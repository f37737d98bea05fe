// SPDX-License-Identifier: BSD-3-Clause
// What a CAD or mesh file contains, as understood.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "session/options.hpp"
#include "world/import/cad_file.hpp"
#include "world/model/world.hpp"

namespace straytrace {

bool is_geometry(std::string const& file);  // by its ending
// Prints parts, colours, faces, areas, size, findings and an entry for a scene. `units`: of the numbers in the file, in
// place of what it says; empty: as it says. `plot`: a PNG file, none when empty.
int inspect_geometry(std::string const& file, std::string const& units, std::string const& plot, PrintOptions const&);

// A CAD or mesh file as a list of parts, and as a world to draw.

struct GeometryPart {
  std::string name, material, colour;        // empty: the file says none
  std::map<std::string, std::size_t> faces;  // by kind: plane, cylinder ... freeform, triangle
  double area = 0;                           // m^2
  std::string closed;                        // of meshes, in words
};

struct GeometryFile {
  std::string format, unit;  // in words
  bool unit_known = false;   // otherwise lengths are in the unit of the file
  double scale = 1;          // m per unit of the numbers in `box` as read
  Box box;                   // m
  std::vector<GeometryPart> parts;
  std::vector<MeshFault> notes;  // what is suspicious
  World world;
};

// Throws InputError.
GeometryFile read_geometry(std::string const& file, std::string const& units);

}  // namespace straytrace
