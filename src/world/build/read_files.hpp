// SPDX-License-Identifier: BSD-3-Clause
// Scene entries with `file`: meshes and CAD geometry. Rules give materials to their parts by name or colour.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/memory/storage.hpp"
#include "geometry/shape_types.hpp"
#include "world/build/read_parts.hpp"
#include "world/import/cad_file.hpp"
#include "world/import/mesh_file.hpp"

namespace straytrace::world {

// A part as its file names it. Rules match the complete name, "tower/dump", or its last piece, "dump".
struct PartLabel {
  std::string name, material, colour;  // colour "#rrggbb"; empty: not in the file
};

// Rows of the table `surfaces` or `medium` of an entry, in the order of the scene, then its default, then for
// `surfaces` the `material` of the entry: the first match counts.
class PartRules {
 public:
  PartRules(Scene::Instance const&, std::string_view table, bool first_time);
  // The value for a part; empty: no rule matches.
  Node of(PartLabel const&);
  // The optic of a part; if no rule matches, the black one, and report() says so.
  std::uint32_t optic(PartLabel const&, Registry const&);
  // One problem for rules that match nothing, one for parts without material. `parts`: all parts of the file `name`.
  void report(Scene::Instance const&, std::string const& name, std::vector<PartLabel> const& parts) const;

 private:
  struct Rule {
    std::string pattern, colour;  // of a rule by colour only the colour
    Node says;
    bool used = false;
    bool fits(PartLabel const&) const;
  };
  void add(std::string const& pattern, Node const& says, bool complain);

  std::vector<Rule> rules_;
  std::vector<std::string> bare_;
};

// The volume of a part, filled with the medium that a node names.
using FillPart = std::function<std::uint32_t(Node const& medium, std::string const& part)>;

// m per unit of the file; 0 after a problem. `box`: in units of the file. `stated`: m, the unit that the file states,
// or 0. `source` for messages: "its format says m".
double read_file_unit(Scene::Instance const&, Box const& box, double stated, std::string const& source,
                      bool first_time);

// A warning about the file that `file` names.
void warn_of_file(Node const& file, std::string const& what, std::string const& suggestion);

// Mesh files read so far, by name; instances share the arrays.
struct LoadedMesh {
  MeshFile file;
  std::vector<MeshContent> content;  // of each part
  bool sound = false;
};
using MeshLibrary = std::map<std::string, std::shared_ptr<LoadedMesh const>>;

// Adds one surface per part of a mesh file. `file`: its name in the scene. `as`: body and volume. `side`: which sides
// scatter, the other absorbs. FillPart: for parts with a medium of their own. `first_time`: first instance of an entry.
void add_mesh(Scene::Instance const&, Node const& file, Pose const&, Surface as, std::string const& side,
              FillPart const&, bool first_time, World&, Registry&, MeshLibrary&);

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

// The faces of one name and colour, for which rules choose the material.
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

// The converted text of a STEP file, or the file itself if it is converted; stored with the other texts of the model.
// Empty after a problem.
std::string cad_text(Node const& file);

// Adds one surface per face, in groups by part. Arguments as of add_mesh ; normals point out of the
// part.
void add_cad(Scene::Instance const&, Node const& file, Pose const&, Surface as, std::string const& side,
             FillPart const&, bool first_time, World&, Registry&, CadLibrary&);

}  // namespace straytrace::world
