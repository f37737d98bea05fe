// SPDX-License-Identifier: BSD-3-Clause
// Scene entries with `file`: meshes and CAD geometry. Rules give materials to their parts by name or colour.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>

#include "base/memory/storage.hpp"
#include "geometry/shape_types.hpp"
#include "world/build/read_parts.hpp"
#include "world/import/cad_file.hpp"

namespace straytrace::world {

// The volume of a part, filled with the medium that a node names.
using FillPart = std::function<std::uint32_t(Node const& medium, std::string const& part)>;

// An instance of a scene entry whose surfaces a file describes.
struct PlacedFile {
  Scene::Instance const& instance;
  Node const& file;  // its name
  Pose const& pose;
  Surface as;               // body and volume
  std::string const& side;  // that scatters, the other absorbs
  FillPart const& fill;     // for parts with a medium of their own
  bool first_time;          // first instance of the entry
};

// Files read so far, by name; instances share the arrays.
struct LoadedMesh;
struct LoadedCad;
struct FileLibrary {
  std::map<std::string, std::shared_ptr<LoadedMesh const>> meshes;
  std::map<std::string, std::shared_ptr<LoadedCad>> cads;
  std::map<std::string, MeshContent> smooth;  // meshes with normals at their corners
};

// Adds one surface per part of a mesh file or per face of a STEP file, whose normals point out of the part.
void add_file(PlacedFile const&, World&, Registry&, FileLibrary&);

// Faces of a STEP file, as converted by straytrace-step: complete cylinders, cones, caps and disks become those shapes,
// all others a CadFace. All normals point out of the part.
using CadShape = std::variant<CadFace, Disk, Cap, Sphere, Zone, Cylinder, Cone, Torus>;

// A shape and its place in the frame of the file.
struct PlacedCadShape {
  CadShape shape;
  Pose frame;
};

// `scale`: m per metre of the file.
PlacedCadShape cad_shape(CadFileFace const&, double scale, Storage&);

}  // namespace straytrace::world
