// SPDX-License-Identifier: BSD-3-Clause
// Scene entries with `file`: every named part of a mesh file becomes one surface.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "world/build/file_parts.hpp"
#include "world/import/mesh_file.hpp"

namespace straytrace {

// Mesh files read so far, by name; instances share the arrays.
struct LoadedMesh {
  MeshFile file;
  std::vector<MeshContent> content;  // of each part
  bool sound = false;
};
using MeshLibrary = std::map<std::string, std::shared_ptr<LoadedMesh const>>;

// Adds one surface per part. `file` is the name as written; `as` says body and volume; `side` which sides scatter, the
// other absorbs. FillPart: for parts with a medium of their own. `first_time`: of several instances of one entry.
void add_mesh(Scene::Instance const&, Node const& file, Pose const&, Surface as, std::string const& side,
              FillPart const&, bool first_time, World&, Registry&, MeshLibrary&);

}  // namespace straytrace
