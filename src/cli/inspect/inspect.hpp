// SPDX-License-Identifier: BSD-3-Clause
// Output of `straytrace inspect` for CAD and mesh files, motion and measured scatter.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "session/options.hpp"
#include "world/import/cad_file.hpp"
#include "world/model/world.hpp"
#include "world/scatter_data/scatter_fit.hpp"

namespace straytrace::cli {

bool is_geometry(std::string const& file);  // by its ending
// Prints parts, colours, faces, areas, size, findings and an entry for a scene. `units`: of the numbers in the file,
// overriding the file; empty: those of the file. `plot`: a PNG file, none when empty.
int inspect_geometry(std::string const& file, std::string const& units, std::string const& plot, PrintOptions const&);

// A CAD or mesh file as a list of parts, and as a world to draw.

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

// Throws InputError.
GeometryFile read_geometry(std::string const& file, std::string const& units);

// Whether a scene moves bodies and has no materials to show.
bool shows_motion(Scene const&);
// Prints rms per body and coordinate; `plot`: a file of results/curves/curve_file.hpp with the ASDs, none when empty.
int inspect_motion(Scene const&, std::string const& plot, PrintOptions const&);

struct ScatterRequest : PrintOptions {
  std::string file, beyond = "constant", angles, wavelength,
                    entry;             // as the keys of the model `table`; empty: as the file declares
  std::string plot, write;             // PNG and SSDD to write; empty: none
  std::vector<std::string> overrides;  // of the scene that holds the material
};
int inspect_scatter(ScatterRequest const&);

// Audit and fits of measured scatter as text.

std::string scatter_text(std::string const& name, ScatterFile const&, ScatterAudit const&,
                         std::vector<ScatterFit> const&, std::string const& beyond);

}  // namespace straytrace::cli
