// SPDX-License-Identifier: BSD-3-Clause
// The paths of a coupling table as fields of one realisation: amplitudes and static phases.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ifo/interferometer.hpp"
#include "noise/time_domain/motion_series.hpp"
#include "noise/time_domain/phase_sum.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

struct StrayPath {
  PortId port;
  double amplitude = 0;                                   // root of the recoupled power that it represents
  double turns = 0;                                       // static phase over 2 pi
  double length = 0;                                      // m, optical
  std::span<PhaseSensitivity const> phase_sensitivities;  // in the table
  std::uint32_t route = 0, record = 0;
};

struct PathChoice {
  std::vector<std::uint32_t> routes;  // positions in CouplingTable::classes
  std::size_t per_route = 0;          // fields per route; 0: one for each record
  std::uint64_t seed = 1;
  std::uint32_t realisation = 0;
};

// Fields whose mean powers sum, route by route, to C_rev times the mean coupling times the copies of the port.
// `per_route` below the number of records: so many of equal power, picked by systematic sampling with the chance of
// their weights (deterministic routes always keep all). Static phases are uniform, a function of seed, realisation,
// route and address of the record, and copy (docs/theory/path_integral.md): one realisation of the speckle. Copies of a
// port have the same motion. The paths of a coherent family have the phases of their fields, and one common phase per
// principal state of polarisation and realisation (eq. 10.5).
std::vector<StrayPath> stray_paths(CouplingTable const&, Interferometer const&, PathChoice const&);

enum class Delay : std::uint8_t { none, half_path };
// Input of phase_sum, for paths of one motion; coordinates that move none of them are left out. `half_path`: each
// path sees the motion delayed by half of its optical length, to first order in the delay (docs/theory/phase.md,
// eq. 2.6).
PhaseTerms phase_terms(std::span<StrayPath const>, MotionSeries const&, Delay = Delay::none);

// Largest instantaneous fringe frequency |dphi/dt|/2pi (eq. 7.1) and where it is.
struct FastestFringe {
  double hz = 0;
  std::size_t path = 0;  // position
  double time = 0;       // GPS s
};
FastestFringe fastest_fringe(std::span<StrayPath const>, MotionSeries const&);

// The route with the largest moving power, the sum over its paths of p (1 - exp(-phi^2)) (docs/theory/time_domain.md,
// "The rms phase"): p is the power of a path [1], phi [rad] the rms over time of the moving part of its phase.
struct MovingRoute {
  std::uint32_t route = 0;  // as StrayPath::route; the first of the chosen ones if nothing moves
  double rms_phase = 0;     // rad: rms over time, and over the paths of the route by power
};
MovingRoute moving_route(std::span<StrayPath const>, MotionSeries const&);

}  // namespace straytrace::noise
