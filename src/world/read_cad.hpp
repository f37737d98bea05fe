// SPDX-License-Identifier: BSD-3-Clause
// Scene entries whose `file` is a STEP file or one that straytrace-step has converted.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "world/cad_shapes.hpp"
#include "world/file_parts.hpp"

namespace straytrace {

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
