// SPDX-License-Identifier: BSD-3-Clause
// Scene and paths for other programs: ParaView (VTK XML), slides (GLB), and curves as CSV.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/scene_drawing.hpp"
#include "results/results.hpp"

namespace straytrace::report {

using NamedTexts = std::vector<std::pair<std::string, std::string>>;  // name of a file and its content

// straytrace.vtm, a file for each part below parts/, paths.vtp, and names.csv with the names of all numbers in them.
// Points are in m, float64; paths carry their route, coupling, strain at the frequencies of the table, and moving body.
// `table` may be null: no paths then.
NamedTexts vtk_files(World const&, SceneDrawing const&, std::vector<DrawnPath> const&, PathTable const* table);

// Binary glTF 2.0: parts named as in the scene, with origins of their own, and a line set for each route. Lengths in m;
// glTF holds float32, so places are rounded to 1 mm at 10 km.
std::string glb_bytes(SceneDrawing const&, std::vector<DrawnPath> const&, PathTable const* table);

// budget.csv (total, bands, design), routes.csv (every route's ASD and its error), paths.csv (the table).
NamedTexts curve_files(RunContent const&, PathTable const&);

}  // namespace straytrace::report
