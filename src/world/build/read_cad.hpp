// SPDX-License-Identifier: BSD-3-Clause
// Scene entries whose `file` is a STEP file or one that straytrace-step has converted.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <variant>

#include "base/memory/storage.hpp"
#include "geometry/shape_types.hpp"
#include "world/build/file_parts.hpp"
#include "world/import/cad_file.hpp"

namespace straytrace {

// Faces of a CAD file as shapes: full cylinders, cones, caps and disks become those, all others a CadFace. All normals
// point out of the part.

using CadShape = std::variant<CadFace, Disk, Cap, Sphere, Zone, Cylinder, Cone, Torus>;

// A shape with where it stands in the frame of the file.
struct PlacedCadShape {
  CadShape shape;
  Pose frame;
};

// `scale`: m per metre of the file.
PlacedCadShape cad_shape(CadFileFace const&, double scale, Storage&);

// What rules choose materials for: the faces of one name and colour.
struct CadPart {
  PartLabel label;
  std::vector<PlacedCadShape> faces;
  MeshContent triangles;  // m of the file; none when empty
};
struct LoadedCad {
  CadFile file;
  std::map<double, std::vector<CadPart>> scaled;  // by m per metre of the file
};
using CadLibrary = std::map<std::string, std::shared_ptr<LoadedCad>>;

// The converted text of a STEP file, or the file itself when it is converted; kept with the other texts of the model.
// Empty after a problem.
std::string cad_text(Node const& file);

// Adds one surface per face, in groups by part. Arguments as of add_mesh (read_mesh.hpp); normals point out of the
// part.
void add_cad(Scene::Instance const&, Node const& file, Pose const&, Surface as, std::string const& side,
             FillPart const&, bool first_time, World&, Registry&, CadLibrary&);

}  // namespace straytrace
