// SPDX-License-Identifier: BSD-3-Clause
// A CAD or mesh file as a list of parts, and as a world to draw.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "world/import/mesh_file.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

bool is_geometry(std::string const& file);  // by its ending

struct GeometryPart {
  std::string name, material, colour;        // empty: the file states none
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
  std::vector<MeshFault> notes;  // suspicious findings
  World world;
};

// `units`: of the numbers in the file, instead of those it declares; empty: as declared. Throws InputError.
GeometryFile read_geometry(std::string const& file, std::string const& units);

}  // namespace straytrace::world
