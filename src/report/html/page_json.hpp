// SPDX-License-Identifier: BSD-3-Clause
// Data of a page as JSON: the scripts of the page only draw it. Lengths in m, couplings over
// the main mode, strain as one-sided ASD in 1/sqrt(Hz); null: not resolved or not known.
#pragma once

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "report/scene_drawing.hpp"
#include "results/results.hpp"
#include "scene/scene.hpp"
#include "world/model/receiver.hpp"
#include "world/model/world.hpp"

namespace straytrace::report {

// One self-contained HTML file: it loads nothing, and its content security policy forbids loading. A page of a program
// that runs may ask that program alone.

struct HtmlPage {
  std::string title, body;            // body: HTML shown without scripts
  nlohmann::json data;                // for the scripts
  std::vector<std::string> scripts;   // of data/page, in order
  bool plots = false, scene = false;  // libraries that they need
  bool live = false;                  // served by the program itself (io/loopback_server.hpp)
};
std::string html_text(HtmlPage const&);

// Summary sentence, picture, table and text of a run as HTML, for browsers without scripts.
struct Picture {
  std::string type, bytes;  // "png", "svg+xml"; no bytes: none
};
struct StaticReport {
  std::string verdict, headline, text;
  Picture picture;  // of the budget
  std::size_t most_rows = 5000;
};
std::string static_head(StaticReport const&);
std::string static_body(StaticReport const&, PathTable const&);

// Third-party scripts inside pages, from packages that CMake found.

struct PageScript {
  std::string_view name, licence, text;
};
PageScript const& d3_script();  // https://d3js.org, BSD-3-Clause
// https://threejs.org, MIT: the library, then its orbit controls; `text`: gzip as base64.
std::span<PageScript const> three_scripts();

// Maps of surfaces: the square centimetres that cause the noise, and the light arriving on them.

struct CellValues {
  std::vector<MapCell> cells;
  std::vector<double> value, error;  // one standard error
  std::vector<double> area;          // m^2 of the map, of one surface on average: what lies beyond its rim is left out
  std::vector<std::uint32_t> count;  // of paths or arrivals; 0: none seen
};

// One map for all instances of a name, laid over one another in the frame of their shape. Round shapes are mapped in
// polar coordinates about their axis, others in x and y perpendicular to it. Cylinders, and shapes longer than wide,
// are unrolled. Areas are those of the map. Cells and values depend on the run alone, not on how it was traced.
struct SurfaceMap {
  std::string name;
  GroupId group;
  Chart chart = Chart::plane;
  MapCell whole;
  Vec3 x_axis, y_axis;       // of the first instance, in the scene; unrolled: the arc begins at x and grows towards y
  std::size_t surfaces = 0;  // laid over one another
  // Noise: share of the strain noise power of the band that is made in a cell [1], by weight of kept paths. The error
  // is that of their number, sqrt(sum of squares). A path that meets the moving body twice counts half at each place.
  CellValues noise;
  double noise_sum = 0;  // over all cells
  // Light: power arriving per area over the power of the main mode [1/m^2], of `histories` of the run; the cells were
  // made with others of its histories.
  CellValues light;
  std::uint64_t histories = 0;
  // The same noise along the scene: by surface, with the place of its reference point.
  std::vector<Vec3> places;
  std::vector<double> noise_by_place, noise_by_place_error;
};

// A path with its part of the noise, which is made where it meets the moving body.
struct NoisyPath {
  DrawnPath path;
  double noise = 0;  // share of the strain noise power of the band [1]
  BodyId body = {};  // whose motion contributes most
};
std::vector<SurfaceMap> noise_maps(World const&, std::vector<NoisyPath> const&, std::size_t most);
// Adds the light of the first histories of the run.
void add_light(SteeredWorld const&, std::uint64_t seed, std::uint64_t histories, std::vector<SurfaceMap>&);

}  // namespace straytrace::report

namespace straytrace::wave {
struct ArmCavity;
struct WaveRecord;
}  // namespace straytrace::wave

namespace straytrace::report {

using PageJson = nlohmann::json;

PageJson number(double);  // null unless finite; six digits, which is more than a picture shows
PageJson numbers(std::vector<double> const&);

PageJson budget_json(NoiseBudget const&, PathTable const&, std::size_t routes);
// By columns, since there may be 1e5 rows; titles and units are in `columns`.
PageJson table_json(PathTable const&);
PageJson provenance_json(RunContent const&);
PageJson energy_balance_json(RunContent const&);  // terms of the energy balance and objects, each with its error
PageJson convergence_json(RunContent const&,
                          PathTable const&);  // error against histories, from the replicas; figures of merit
PageJson inputs_json(RunContent const&);      // uncertain inputs, and their share of the noise
PageJson receivers_json(RunContent const&, World const&);  // routes and maps of receivers
PageJson maps_json(std::vector<SurfaceMap> const&, double beam_power);

// Mean irradiance over the power of the mode [1/m^2] of the light that mirror 0 or 1 scatters, at a distance along and
// from the axis [m] (docs/theory/wave.md, eq. W.17).
using ScatteredLight = std::function<double(std::size_t mirror, double distance, double off_axis)>;
PageJson wave_json(wave::WaveRecord const&, ScatteredLight const&);
// Where its light at small angles falls on the surfaces of a scene.
PageJson halo_json(World const&, wave::ArmCavity const&, wave::WaveRecord const&);

PageJson scene_json(SceneDrawing const&);
PageJson paths_json(World const&, std::vector<DrawnPath> const&);
PageJson rays_json(World const&, std::vector<RaySegment> const&);
PageJson told_json(std::vector<HistoryEvent> const&);
PageJson lit_json(World const&);  // spots of beams on surfaces, and ports

// Optical properties of a material, for scripts and pages.

inline constexpr double material_angles[] = {0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 89};  // deg of incidence, of shares
inline constexpr double material_incidences[] = {0, 30, 60, 80};                          // deg, of BSDF curves
std::vector<double> material_offsets(int per_decade, double low, double high);            // |alpha - alpha_0|

// Laws, shares of the light against incidence, BSDF curves against |alpha - alpha_0|.
nlohmann::json material_json(WorldView const&, MaterialInfo const&, std::vector<std::string> const& notes,
                             int per_decade = 30);

// All materials of a scene, with the measured points of tables: {deg, offset, bsdf} each, and their uncertainties.
nlohmann::json materials_json(Scene const&, World const&);

}  // namespace straytrace::report
