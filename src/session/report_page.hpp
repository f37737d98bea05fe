// SPDX-License-Identifier: BSD-3-Clause
// The pages of `straytrace report` and `straytrace view`: runs and scenes gathered into one HTML file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "report/html/page_json.hpp"
#include "report/scene_drawing.hpp"
#include "results/ghosts/ghost_table.hpp"
#include "results/results.hpp"
#include "session/model.hpp"

namespace straytrace::session {

struct ReportWanted {
  std::string title;                  // empty: of the scene
  std::size_t rows = 50;              // of the path table, whose paths are drawn
  std::size_t paths = 12;             // drawn of each of them
  std::vector<std::string> pictures;  // of report_pictures(); empty: all
  std::string measured;               // strain over the noise: measured_json(); empty: none
  bool has(std::string const& picture) const;
};
std::vector<std::string> const& report_pictures();  // budget, scene, maps, wave, ghosts, materials, convergence
// `pictures` of the table `report` of a scene; an unknown word is a problem there. Empty: all.
std::vector<std::string> read_pictures(Node const& report);

// Prepares the world of a run when paths are to be traced again.
using TracedAgain = std::function<SteeredWorld const&()>;

// The page of a run; `picture`: for browsers without scripts.
std::string report_page(RunContent const&, PathTable const&, Model const&, TracedAgain const&, ReportWanted const&,
                        Picture const&);

struct ViewWanted {
  std::string title;
  std::uint64_t rays = 200;  // sample histories
  std::size_t rows = 12, paths = 12;
  bool halo = false;  // light at small angles of the field that the model has
};
// A scene with its beams, ghosts, sample rays and light at small angles; with a run also the paths of its first rows.
std::string view_page(Model const&, TracedAgain const&, RunContent const* run, PathTable const*, ViewWanted const&);

// Paths of the first rows of the table, and of the routes to receivers, `paths` of each; of routes that were computed
// those of the ghosts in the reports.
std::vector<DrawnPath> paths_of_rows(CouplingTable const&, PathTable const&, World const&, TracedAgain const&,
                                     std::vector<GhostReport> const&, std::size_t rows, std::size_t paths);
constexpr std::size_t ghosts_shown = 60;  // rows of each beam
// Ghosts of all launched beams as the scene says, or the strongest down to 1e-12 and order 2.
std::vector<GhostReport> ghosts_for_page(Model const&, std::size_t rows);

// The picture of a run as SVG; empty, and `message` says why, when it cannot be drawn.
Picture budget_svg(std::string const& run_file, std::string const& measured, std::string& message);

}  // namespace straytrace::session
