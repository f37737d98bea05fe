// SPDX-License-Identifier: BSD-3-Clause
// Data of a page as JSON: the scripts of the page only draw it. Lengths in m, couplings over
// the main mode, strain as one-sided ASD in 1/sqrt(Hz); null: not resolved or not known.
#pragma once

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

#include "report/html/surface_maps.hpp"
#include "report/ray_paths.hpp"
#include "report/scene_drawing.hpp"
#include "results/results.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

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
