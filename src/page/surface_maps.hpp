// SPDX-License-Identifier: BSD-3-Clause
// Where on a surface: the square centimetres that make the noise, and the light that arrives on them.
#pragma once

#include <string>
#include <vector>

#include "page/ray_paths.hpp"

namespace straytrace {

// All instances of a name are laid over one another, in the frame of their shapes: as seen along the axis (x, y), or,
// where the shape is longer than wide or a cylinder, unrolled (height along the axis, arc). Areas are those of the map.
// Row 0 is the lowest y, column 0 the least x.
struct SurfaceMap {
  std::string name;
  bool unrolled = false;
  std::size_t columns = 0, rows = 0;
  double x_low = 0, x_high = 0, y_low = 0, y_high = 0;  // m
  std::size_t surfaces = 0;                             // laid over one another
  // Noise: share of the strain noise power of the band that is made in a cell [1], by weight of kept paths; one
  // standard error; number of paths. A path that meets the moving body twice counts half at each place.
  std::vector<double> noise, noise_error;
  std::vector<std::uint32_t> paths;
  double noise_sum = 0;
  // Light: power arriving per area over the power of the main mode [1/m^2], and one standard error, of `histories`.
  std::vector<double> light, light_error;
  std::uint64_t histories = 0;
  // The same noise along the scene: by surface, with the place of its reference point.
  std::vector<Vec3> places;
  std::vector<double> noise_by_place;
  double cell_area() const { return (x_high - x_low) * (y_high - y_low) / double(columns * rows); }
};

// A path with its part of the noise, which is made where it meets the moving body.
struct NoisyPath {
  DrawnPath path;
  double noise = 0;  // share of the strain noise power of the band [1]
  BodyId body = {};  // whose motion contributes most
};
std::vector<SurfaceMap> noise_maps(World const&, std::vector<NoisyPath> const&, std::size_t most);
// Adds the light of the first histories of the run.
void add_light(World const&, std::uint64_t seed, std::uint64_t histories, std::vector<SurfaceMap>&);

}  // namespace straytrace
