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

namespace straytrace {

// A part as its file names it. Rules see the whole name, "tower/dump", and its last piece, "dump".
struct PartLabel {
  std::string name, material, colour;  // colour "#rrggbb"; empty: the file says none
};

// Rows of a table of an entry, `surfaces` or `medium`, in the order of the scene, then its default, then for `surfaces`
// the `material` of the entry: the first that fits counts.
class PartRules {
 public:
  PartRules(Scene::Instance const&, std::string_view table, bool first_time);
  // What the rules say of a part; empty when none fits.
  Node of(PartLabel const&);
  // The optic of a part; everything black, and a note for report(), when no rule fits.
  std::uint32_t optic(PartLabel const&, Registry const&);
  // What fits nothing, and parts without material, in one problem each. `parts`: all of the file `name`.
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

// The volume of a part that is filled with the medium that a node names.
using FillPart = std::function<std::uint32_t(Node const& medium, std::string const& part)>;

// m per unit of the file; 0, and a problem, when it is not known. `box`: in units of the file. `stated`: m, 0 when the
// file says none. `source` for messages: "its format says m".
double read_file_unit(Scene::Instance const&, Box const& box, double stated, std::string const& source,
                      bool first_time);

// A warning about the file that `file` names.
void warn_of_file(Node const& file, std::string const& what, std::string const& suggestion);

// Scene entries with `file`: every named part of a mesh file becomes one surface.

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

// Scene entries whose `file` is a STEP file or one that straytrace-step has converted.

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

// Adds one surface per face, in groups by part. Arguments as of add_mesh ; normals point out of the
// part.
void add_cad(Scene::Instance const&, Node const& file, Pose const&, Surface as, std::string const& side,
             FillPart const&, bool first_time, World&, Registry&, CadLibrary&);

}  // namespace straytrace
