// SPDX-License-Identifier: BSD-3-Clause
// Output of `straytrace inspect` for CAD and mesh files, motion and measured scatter.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "session/options.hpp"

namespace straytrace::cli {

// Prints parts, colours, faces, areas, size, findings and an entry for a scene. `units`: of the numbers in the file,
// overriding the file; empty: those of the file. `plot`: a PNG file, none when empty.
int inspect_geometry(std::string const& file, std::string const& units, std::string const& plot, PrintOptions const&);

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

}  // namespace straytrace::cli
