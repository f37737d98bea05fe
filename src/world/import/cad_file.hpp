// SPDX-License-Identifier: BSD-3-Clause
// CAD geometry converted from STEP by straytrace-step: exact faces, by part and colour. Lengths in m, by the unit that
// the STEP file states. Format: docs/reference/cad.md.
#pragma once

#include <string>
#include <vector>

#include "geometry/cad/cad_face.hpp"
#include "world/import/mesh_file.hpp"

namespace straytrace::world {

struct CadFileFace {
  Carrier carrier = Carrier::plane;
  Pose frame;  // of the carrier (cad_face.hpp)
  double radius = 0, second = 0;
  bool flipped = false;  // the outside of the part is against the normal of the carrier
  bool natural = false;  // ends at full circles: `from` and `to` are radii of a plane or cone, heights of others
  double from = 0, to = 0;
  std::vector<ChartLoop> loops;  // otherwise
};

struct CadFilePart {
  std::string name, colour;  // "tower/dump"; "#202020", empty: not in the file
  std::vector<CadFileFace> faces;
  std::vector<MeshVertex> vertices;  // m, of faces converted to triangles
  std::vector<MeshTriangle> triangles;
  std::size_t freeform = 0;  // number of these faces
};

struct CadFile {
  std::string made_by, schema;
  double unit = 0;  // m per unit of the STEP file; 0: it has several
  bool unit_stated = false;
  double tolerance = 0, chord = 0;  // m: of trimming, of triangles
  Box box;
  std::vector<CadFilePart> parts;
  std::vector<MeshFault> notes;

  Box box_in_unit() const;
};

bool is_step(std::string const& name);       // by its ending
bool is_converted(std::string const& name);  // *.cad.json

MeshFault read_cad_file(std::string const& text, CadFile& out);

// Runs straytrace-step on a STEP file and caches the result, by content, for the user.
struct StepConversion {
  std::string text;  // a *.cad.json; empty: see fault
  MeshFault fault;
};

// `name` for messages. The converter is STRAYTRACE_STEP, or straytrace-step next to this program or in PATH. Cache:
// straytrace/step in XDG_CACHE_HOME or ~/.cache; without either there is no cache.
StepConversion convert_step(std::string const& name, std::string const& bytes);

}  // namespace straytrace::world
