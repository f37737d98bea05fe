// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "wave/arm/grid_check.hpp"
#include "wave/ring/ring_heights.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

void report(ArmOptions const& options, std::string const& what) {
  if (options.progress) options.progress(what);
}

RingWaves solve_planned(World const& world, WaveSettings const& settings, RingCavity ring, ArmOptions const& options) {
  throw_errors(ring.problems);
  add_ring_heights(ring, world, settings);
  RoundTrip trip(ring.trip, {int(thread_count(unsigned(options.threads))), options.device});
  auto const pure = [&](int n, int m) { return trip.hermite_gauss(ring.start[0], ring.start[1], n, m); };
  SolveOptions solve;
  solve.loss_error = 1e-7;  // of first order in the residual: the round trip is not symmetric
  solve.progress = [&](int trips, double residual) {
    report(options, fmt::format("round trip {}, residual {:.1e}", trips, residual));
  };
  WaveMode mode = [&] {
    try {
      return trip.mode(pure(0, 0), solve);
    } catch (NumericalError const& e) {
      throw InputError(fmt::format("wave: the cavity holds no mode that resembles a Gaussian beam: {}", e.what()),
                       "enlarge the mirrors and the openings of baffles, or change the curvatures");
    }
  }();
  if (mode.loss() > 0.01)
    ring.warnings.push_back(
        fmt::format("wave: the mode loses {:.2g} of its power per round trip: mirrors or baffles clip the beam itself",
                    mode.loss()));
  std::vector<ModeLine> modes;
  if (options.highest_order >= 0) {
    SolveOptions coarse;
    coarse.loss_error = 1e-2;
    coarse.progress = [&](int, double residual) {
      report(options, fmt::format("higher modes, residual {:.1e}", residual));
    };
    modes = mode_table(trip, pure, options.highest_order, coarse);
  }
  report(options, "balance of power");
  TripLosses losses = trip.losses(mode);
  solve.progress = [&](int trips, double residual) {
    report(options, fmt::format("the other way around, round trip {}, residual {:.1e}", trips, residual));
  };
  RingLevers levers = ring_levers(world, ring, trip, mode, solve);
  for (TripStop& stop : ring.trip.stops)
    if (stop.mirror) stop.mirror->height = {};  // the round trip has them
  return {
      std::move(ring), std::move(trip), std::move(mode), std::move(modes), std::move(losses), std::move(levers), {}};
}

// Of the displacements of all edges, or of all mirrors: the largest change over the rms.
double largest_change(RingLevers const& coarse, RingLevers const& finer, bool mirrors) {
  double largest = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < coarse.surfaces.size(); ++i) {
    if (coarse.surfaces[i].mirror != mirrors) continue;
    double change = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Complex const before = coarse.surfaces[i].levers.displacement[axis];
      change += std::norm(finer.surfaces[i].levers.displacement[axis] - before);
      squares += std::norm(before);
    }
    largest = std::fmax(largest, std::sqrt(change));
    ++count;
  }
  return squares > 0 ? largest / std::sqrt(squares / count) : not_a_number;
}

RingGridCheck difference(RingWaves const& finer, RingWaves const& coarse) {
  RingGridCheck check;
  check.points = finer.ring.trip.grid.points;
  check.loss = finer.mode.loss() - coarse.mode.loss();
  check.losses = finer.losses;
  for (std::size_t i = 0; i < check.losses.taken.size(); ++i) check.losses.taken[i] -= coarse.losses.taken[i];
  check.losses.beyond_band -= coarse.losses.beyond_band;
  check.phase = coarse.modes.empty() ? not_a_number : 0;
  for (std::size_t i = 0; i < std::min(finer.modes.size(), coarse.modes.size()); ++i)
    check.phase = std::fmax(check.phase, std::fabs(std::remainder(finer.modes[i].phase - coarse.modes[i].phase, 1.0)));
  check.edges = largest_change(coarse.levers, finer.levers, false);
  check.mirrors = largest_change(coarse.levers, finer.levers, true);
  return check;
}

}  // namespace

RingWaves solve_ring(World const& world, WaveSettings const& settings, RingCavity planned, ArmOptions const& options) {
  std::optional<WaveSettings> finer;  // first, since it may not exist
  if (options.grid_check) finer = finer_settings(settings, planned.crossover, planned.trip.grid);
  RingWaves waves = solve_planned(world, settings, std::move(planned), options);
  if (!finer) return waves;
  ArmOptions second = options;
  second.progress = [&](std::string const& what) { report(options, "finer grid, " + what); };
  waves.grid_check = difference(solve_planned(world, *finer, planned_ring(world, *finer), second), waves);
  return waves;
}

namespace {

struct DrivingBeam {
  Field spectrum;
  std::vector<double> orders;  // its shares in the modes of the mirrors
};

DrivingBeam driving_beam(WaveSettings::Input const& input, RingWaves const& waves, int highest_order) {
  auto const& start = waves.ring.start;
  auto const along = [&](std::size_t axis) {
    return AxisBeam{input.radius.value_or(start[axis].radius),
                    input.wavefront_curvature.value_or(start[axis].curvature), input.shift[axis], input.tilt[axis]};
  };
  DrivingBeam beam{waves.trip.hermite_gauss(along(0), along(1)), {}};
  Grid const& grid = waves.ring.trip.grid;
  double const unit_power = std::pow(grid.pitch() / grid.points, 2);
  for (int order = 0; order <= highest_order; ++order) {
    double share = 0;
    for (int m = 0; m <= order; ++m) {
      Field const mode = waves.trip.hermite_gauss(start[0], start[1], order - m, m);
      Complex sum = 0;
      for (std::size_t i = 0; i < mode.values.size(); ++i) sum += std::conj(mode.values[i]) * beam.spectrum.values[i];
      share += std::norm(sum * unit_power);
    }
    beam.orders.push_back(share);
  }
  return beam;
}

void check_entered(double entered, std::string const& mirror, std::vector<std::string>& warnings) {
  constexpr double most = 0.99, least = 0.01;
  if (entered >= most) return;
  std::string const what = fmt::format("only {:.2g} of the power of the input beam falls on '{}'", entered, mirror);
  if (entered < least) throw InputError(what, "check 'radius' and 'shift' of 'input', and their units");
  warnings.push_back("wave: " + what);
}

}  // namespace

DrivenScan drive_ring(World const& world, WaveSettings const& settings, RingWaves const& waves,
                      std::vector<MirrorCoating> const& coatings, std::vector<double> const& detunings,
                      DriveOptions const& options) {
  RingCavity const& ring = waves.ring;
  auto const coating_of = [&](SurfaceId surface) {
    auto const at = std::ranges::find(settings.mirrors, surface, &WaveSettings::Mirror::surface);
    return coatings[std::size_t(at - settings.mirrors.begin())];
  };
  std::vector<DrivenMirror> mirrors;
  DrivenScan driven;
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    if (!ring.stops[i].mirror) continue;
    mirrors.push_back({i, coating_of(ring.stops[i].surface)});
    driven.surfaces.push_back(ring.stops[i].surface);
    driven.coatings.push_back(mirrors.back().coating);
  }
  std::ranges::rotate(driven.surfaces, driven.surfaces.end() - 1);  // the last is the input mirror
  std::ranges::rotate(driven.coatings, driven.coatings.end() - 1);
  driven.free_spectral_range = speed_of_light / ring.length();
  Field input = waves.mode.spectrum;
  if (settings.input) {
    DrivingBeam beam = driving_beam(*settings.input, waves, options.highest_order);
    driven.input_orders = std::move(beam.orders);
    input = std::move(beam.spectrum);
  }
  DrivenOptions const solve = solve_options(options);
  auto const pure = [&](int n, int m) { return waves.trip.hermite_gauss(ring.start[0], ring.start[1], n, m); };
  DrivenCavity const cavity(waves.trip, std::move(mirrors), pure, waves.mode.eigenvalue, input, detunings, solve);
  if (settings.input) check_entered(cavity.entered(), world.name_of(driven.surfaces[0]), driven.warnings);
  driven.take(cavity, detunings, solve);
  return driven;
}

}  // namespace straytrace::wave
