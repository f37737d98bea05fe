// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/arm/arm_waves.hpp"
#include "wave/heights/height_map.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

WaveCavity without_baffles(WaveCavity cavity) {
  cavity.baffles.clear();
  return cavity;
}

}  // namespace

ArmSolver::ArmSolver(ArmCavity const& arm, Computing const& on, Progress progress)
    : mirrors_(without_baffles(arm.cavity), on), waves_(arm.cavity, on), progress_(std::move(progress)) {}

void ArmSolver::set_heights(std::array<std::vector<double>, 2> const& heights) {
  mirrors_.set_heights(heights);
  waves_.set_heights(heights);
}

WaveMode ArmSolver::mode_of_mirrors() {
  progress_("mode of the mirrors");
  try {
    WaveMode mode = mirrors_.mode(last_ ? *last_ : mirrors_.hermite_gauss());
    last_ = mode.spectrum;
    return mode;
  } catch (NumericalError const& e) {
    throw InputError(fmt::format("wave: the mirrors hold no mode that resembles a Gaussian beam: {}", e.what()),
                     "enlarge the mirrors or change their curvatures");
  }
}

WaveMode ArmSolver::mode(Field const& start) const {
  SolveOptions solve;
  solve.loss_error = 1e-5;  // levers of rims converge as the field, the loss as its square
  solve.progress = [&](int trips, double residual) {
    progress_(fmt::format("round trip {}, residual {:.1e}", trips, residual));
  };
  return waves_.mode(start, solve);
}

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

namespace {

// A spectrum on a finer grid of the same window, up to a factor.
Field on_grid(Field const& spectrum, Grid const& finer) {
  Field out(finer);
  int const n = spectrum.grid.points, more = finer.points - n;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      out(row < n / 2 ? row : row + more, column < n / 2 ? column : column + more) = spectrum(row, column);
  return out;
}

PowerLedger difference(PowerLedger a, PowerLedger const& b) {
  for (std::size_t i = 0; i < a.towards_mirror1.size(); ++i) {
    a.towards_mirror1[i] -= b.towards_mirror1[i];
    a.towards_mirror2[i] -= b.towards_mirror2[i];
  }
  a.mirror1 -= b.mirror1;
  a.mirror2 -= b.mirror2;
  a.beyond_band -= b.beyond_band;
  return a;
}

// Of the levers of the rims as drawn in the scene, along some axes.
double largest_change(std::vector<RimResult> const& rims, CavityRims const& finer, std::vector<int> const& axes) {
  double largest = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < rims.size(); ++i) {
    if (rims[i].draws.empty()) continue;
    for (int const axis : axes) {
      Complex const before = rims[i].draws[0].responses[0].levers.displacement[axis],
                    after = finer.responses[i][0].levers.displacement[axis];
      largest = std::max(largest, std::abs(after - before));
      squares += std::norm(before);
      ++count;
    }
  }
  return squares > 0 ? largest / std::sqrt(squares / count) : std::nan("");
}

// Sum over the edges beyond the grid of <|A_x|^2>.
double expected_squares(World const& world, ArmCavity const& arm, LightOfMirrors const& light) {
  ExpectedLevers const expected(world, arm);
  double sum = 0;
  for (std::size_t i = 0; i < arm.rims.size(); ++i)
    if (!arm.rims[i].in_band) sum += expected(i, light).transverse;
  return sum;
}

}  // namespace

WaveSettings finer_settings(WaveSettings settings, double crossover, Grid const& grid) {
  settings.crossover = crossover;
  settings.window = grid.window;
  settings.points = std::uint32_t(allowed_points(int(std::ceil(std::sqrt(2.0) * grid.points))));
  if (settings.points == 0)
    throw InputError(fmt::format("wave: a grid of {} points is too large to be checked with a finer one", grid.points),
                     "leave out --grid-check, or choose a smaller 'crossover'");
  return settings;
}

ArmCavity finer_arm(World const& world, WaveSettings const& settings, ArmCavity const& arm) {
  return arm_cavity(world, finer_settings(settings, arm.crossover, arm.cavity.grid));
}

GridCheck grid_check(World const& world, ArmCavity const& finer, ArmWaves const& coarse, Computing const& on,
                     std::function<void(std::string const&)> const& progress) {
  ArmSolver const solver(finer, on, [&](std::string const& what) { progress("finer grid, " + what); });
  WaveMode const mode = solver.mode(on_grid(coarse.mode.spectrum, finer.cavity.grid));
  std::vector<std::vector<RimCurve>> curves;
  for (ArmRim const& rim : finer.rims)
    curves.push_back(rim.in_band ? std::vector{curve_of(finer, rim)} : std::vector<RimCurve>{});
  LightMeter meter(finer, solver.waves().cavity());
  CavityRims const rims = rim_responses(solver.waves(), mode, curves, std::ref(meter));
  double const before = expected_squares(world, coarse.arm, coarse.light[0]),
               after = expected_squares(world, finer, std::move(meter).result());
  return {finer.cavity.grid.points,
          mode.loss() - coarse.draws[0].loss,
          difference(solver.waves().ledger(mode), coarse.draws[0].ledger),
          largest_change(coarse.rims, rims, {0, 1}),
          largest_change(coarse.rims, rims, {2}),
          before > 0 ? std::sqrt(after / before) - 1 : std::nan("")};
}

}  // namespace straytrace::wave
