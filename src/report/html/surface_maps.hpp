// SPDX-License-Identifier: BSD-3-Clause
// Maps of surfaces: the square centimetres that cause the noise, and the light arriving on them.
#pragma once

#include <string>
#include <vector>

#include "report/ray_paths.hpp"
#include "world/model/cell_map.hpp"

namespace straytrace::report {

struct CellValues {
  std::vector<MapCell> cells;
  std::vector<double> value, error;  // one standard error
  std::vector<double> area;          // m^2 of the map, of one surface on average: what lies beyond its rim is left out
  std::vector<std::uint32_t> count;  // of paths or arrivals; 0: none seen
};

// All instances of a name are laid over one another, in the frame of their shapes: polar about the axis of round ones,
// in x and y across the axis of others, unrolled where the shape is longer than wide or a cylinder. Areas are those of
// the map. Cells and values are functions of the run alone, independent of how it was traced.
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
