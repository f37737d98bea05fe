// SPDX-License-Identifier: BSD-3-Clause
// A CAD or mesh file as a list of parts and as a world to draw, and the defects of its meshes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "world/import/mesh_file.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// A CAD or mesh file as a list of parts, and as a world to draw.

// Defects of a mesh: holes, edges of more than two triangles, flipped, doubled and flat triangles, wrong scale.
// Self-intersections are not detected.

struct MeshHealth {
  struct Part {
    double area = 0;    // unit of the file, squared
    double volume = 0;  // cubed; of its closed body, by the divergence theorem: negative if inside out
    bool closed = false;
    std::size_t open_edges = 0;
  };
  std::vector<Part> parts;            // as in the file
  std::size_t open_edges = 0;         // of one triangle only, with corners of all parts compared by position
  std::size_t crowded_edges = 0;      // of more than two
  std::size_t opposed_edges = 0;      // of two triangles with opposite orientation
  std::size_t doubled = 0;            // triangles on the corners of another one
  std::size_t flat = 0;               // triangles without area
  std::vector<std::string> inverted;  // parts of closed bodies with inward normals
  Vec3 first_open;                    // middle of one open edge, unit of the file
};
MeshHealth examine(MeshFile const&);
// When no triangle has an area.
MeshFault without_area(MeshHealth const&);

// Removes triangles with two equal corners and inverts closed bodies that are inside out; true: the mesh changed.
bool repair(MeshFile&, MeshHealth const&);

struct MeshAdvice {
  std::string what, suggestion;
};
std::vector<MeshAdvice> advice(MeshFile const&, MeshHealth const&);
// Advice on an implausible size, in units of `unit` metres; empty: plausible.
MeshAdvice scale_advice(Box const&, double unit);

std::string size_text(Box const&, double unit);  // "1.2 m x 300 mm x 5 mm"

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
