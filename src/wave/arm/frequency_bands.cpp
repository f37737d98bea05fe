// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/frequency_bands.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "wave/arm/arm_solver.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::wave {
namespace {

// Octaves down from the crossover angle; the lowest holds all that varies slowly over the beam.
std::vector<double> edges_of(ArmCavity const& arm) {
  double const slowest = 1 / (2 * std::min(arm.mirrors[0].spot, arm.mirrors[1].spot));
  std::vector<double> edges{arm.crossover / arm.cavity.wavelength};
  while (edges.back() / 2 > slowest) edges.push_back(edges.back() / 2);
  edges.push_back(0);
  std::ranges::reverse(edges);
  return edges;
}

std::vector<double> heights_between(std::vector<double> const& height, double from, double to, Grid const& grid,
                                    Transform const& transform) {
  if (height.empty()) return {};
  Field field(grid);
  std::ranges::copy(height, field.values.begin());
  transform.forward(field, grid.points, grid.points);
  double const fewest = periods_across(from, grid), most = periods_across(to, grid);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const periods = grid.window * std::hypot(grid.frequency(row), grid.frequency(column));
      if (!(periods > fewest && periods <= most)) field(row, column) = 0;
    }
  transform.inverse(field, grid.points, grid.points);
  std::vector<double> out;
  for (Complex const z : field.values) out.push_back(z.real());
  return out;
}

// (4 pi/lambda)^2 times the variance of the heights, weighted by the power of the beam.
double scattered(std::vector<double> const& height, double spot, Grid const& grid, double wavelength) {
  double weights = 0, mean = 0, square = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    double const x = grid.at(int(i % std::size_t(grid.points))), y = grid.at(int(i / std::size_t(grid.points)));
    double const weight = std::exp(-2 * (x * x + y * y) / (spot * spot));
    weights += weight;
    mean += weight * height[i];
    square += weight * height[i] * height[i];
  }
  if (!(weights > 0)) return 0;
  mean /= weights;
  return std::pow(4 * pi / wavelength, 2) * (square / weights - mean * mean);
}

}  // namespace

HeightBands frequency_bands(ArmCavity const& arm, ArmSolver& solver) {
  WaveCavity const& cavity = arm.cavity;
  auto const loss_with = [&](std::array<std::vector<double>, 2> const& heights) {
    solver.set_heights(heights);
    return solver.mode(solver.mode_of_mirrors().spectrum).loss();
  };
  HeightBands out;
  out.beyond = arm.mirrors[0].scattered + arm.mirrors[1].scattered;
  double const smooth = loss_with({});
  out.smooth = smooth - out.beyond;
  std::vector<double> const edges = edges_of(arm);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    HeightBand band{edges[i], edges[i + 1]};
    std::array<std::vector<double>, 2> heights;
    for (std::size_t mirror : {0, 1}) {
      heights[mirror] = heights_between(mirror == 0 ? cavity.mirror1.height : cavity.mirror2.height, band.from, band.to,
                                        cavity.grid, solver.waves().transform());
      band.scattered[mirror] = scattered(heights[mirror], arm.mirrors[mirror].spot, cavity.grid, cavity.wavelength);
    }
    band.loss = loss_with(heights) - smooth;
    out.bands.push_back(band);
  }
  return out;
}

}  // namespace straytrace::wave
