// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: STL (text, binary), OBJ, PLY, glTF and GLB, read from bytes in memory. Polygons become triangles. Names
// of parts and materials, and colours, serve rules of the scene; textures are ignored.
#pragma once

#include <assimp/scene.h>

#include <functional>
#include <string>
#include <vector>

#include "geometry/mesh/triangle_mesh.hpp"

namespace straytrace::world {

struct MeshPart {
  std::string name, material;  // empty: not in the file
  std::string colour;          // "#rrggbb": of the material (glTF), of vertices (PLY, STL), of a material library (OBJ)
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;
  std::vector<MeshVertex> normals;  // at the corners of each triangle, 0 where the file has none; empty: nowhere
};

struct MeshFile {
  std::string name;             // as written in the scene
  double stated_unit = 0;       // m, if the format states it (glTF: metres); otherwise 0
  std::vector<MeshPart> parts;  // in file order; equal corners are one vertex
  std::size_t left_out = 0;     // points and lines

  Box box() const;  // in the unit of the file
};

// Bytes of another file that the mesh file names (buffers of glTF), relative to it; empty: there is none. Never called
// with names outside the folder of the mesh file.
using CompanionFile = std::function<std::string(std::string const&)>;

// A defect of the file, for the user.
struct MeshFault {
  std::string what, suggestion;  // empty: none
};

// Fills `out` from `bytes`; the ending of out.name determines the format. The library that reads the file runs in a
// sandboxed copy of this process: a file that makes it crash or exhaust the memory is reported as a fault.
MeshFault read_mesh_file(std::string const& bytes, CompanionFile const& companion, MeshFile& out);
// The same in this process.
MeshFault import_mesh(std::string const& bytes, CompanionFile const& companion, MeshFile& out);

// Colours (Kd, as sRGB) of a material library for the parts that name its materials.
void set_library_colours(std::string const& library, MeshFile&);

// "#rrggbb" (sRGB) of three shares of 1.
std::string colour_text(double red, double green, double blue);
// Colour of the material of a glTF file, whose numbers are linear; empty: it has none.
std::string gltf_colour(aiScene const&, aiMesh const&);
// Colours of the faces, from the vertices: that of the first corner. Empty: no colours, or as many as in a photograph.
std::vector<std::string> vertex_colours(aiMesh const&);

}  // namespace straytrace::world
