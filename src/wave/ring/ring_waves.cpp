// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_waves.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "base/process/threads.hpp"
#include "wave/ring/ring_heights.hpp"

namespace straytrace::wave {
namespace {

void report(ArmOptions const& options, std::string const& what) {
  if (options.progress) options.progress(what);
}

}  // namespace

RingWaves solve_ring(World const& world, WaveSettings const& settings, RingCavity planned, ArmOptions const& options) {
  throw_errors(planned.problems);
  RingCavity ring = std::move(planned);
  add_ring_heights(ring, world, settings);
  RoundTrip const trip(ring.trip, {int(thread_count(unsigned(options.threads))), options.device});
  for (TripStop& stop : ring.trip.stops)
    if (stop.mirror) stop.mirror->height = {};  // the round trip has them
  auto const pure = [&](int n, int m) { return trip.hermite_gauss(ring.start[0], ring.start[1], n, m); };
  SolveOptions solve;
  solve.loss_error = 1e-5;
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
  return {std::move(ring), std::move(mode), std::move(modes), std::move(losses)};
}

}  // namespace straytrace::wave
