// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: STL (text, binary), OBJ, PLY, glTF and GLB, read from bytes in memory. Polygons become triangles; names
// of parts and materials are kept, and colours, by which rules can choose; normals and textures are not used.
#pragma once

#include <assimp/scene.h>

#include <functional>
#include <string>
#include <vector>

#include "geometry/mesh/triangle.hpp"

namespace straytrace {

struct MeshPart {
  std::string name, material;  // empty: the file names none
  std::string colour;          // "#rrggbb": of the material (glTF), of vertices (PLY, STL), of a material library (OBJ)
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;
};

struct MeshFile {
  std::string name;             // as written in the scene
  double stated_unit = 0;       // m, where the format states it (glTF: metres); 0: it does not
  std::vector<MeshPart> parts;  // in file order; equal corners are one vertex
  std::size_t left_out = 0;     // points and lines

  std::size_t triangle_count() const;
  Box box() const;  // in the unit of the file
};

// Bytes of another file that the mesh file names (buffers of glTF), relative to it; empty when there is none. Names
// that leave the folder of the mesh file are never asked for.
using CompanionFile = std::function<std::string(std::string const&)>;

// What is wrong with the file, for the user.
struct MeshFault {
  std::string what, suggestion;  // empty: nothing
};

// Fills `out.parts` and what else the file says from `bytes`; the format follows from the ending of out.name. The
// library that reads it works in a copy of this process, so that a file that makes it crash or take all memory is told.
MeshFault read_mesh_file(std::string const& bytes, CompanionFile const& companion, MeshFile& out);
// The same in this process.
MeshFault import_mesh(std::string const& bytes, CompanionFile const& companion, MeshFile& out);

// Colours (Kd, as sRGB) of a material library for the parts that name its materials.
void set_library_colours(std::string const& library, MeshFile&);

// Colours that mesh files give, as "#rrggbb" of sRGB.

// "#RRGGBB" of three shares of 1.
std::string colour_text(double red, double green, double blue);
// Of the material of a glTF file, whose numbers are linear; empty: it has none.
std::string gltf_colour(aiScene const&, aiMesh const&);
// By face, where the vertices have colours: that of the first corner. Empty: they have none, or so many that they are
// a photograph.
std::vector<std::string> vertex_colours(aiMesh const&);

}  // namespace straytrace
