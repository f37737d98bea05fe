// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/grid_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/errors.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/arm/arm_solver.hpp"
#include "wave/arm/arm_waves.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
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
