// SPDX-License-Identifier: BSD-3-Clause
// Stray light in the time domain: coupling table x motion x interferometer -> h(t), one realisation of the speckle
// (docs/theory/phase.md and docs/theory/spectra.md; R4.03 to R4.11). For measured, recorded or drifting motion, single
// events, specular families; means over realisations agree with project_noise.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "noise/time_domain/phase_sum.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// The paths of a coupling table as fields of one realisation: amplitudes and static phases.

struct StrayPath {
  PortId port;
  double amplitude = 0;                                   // root of the recoupled power that it represents
  double turns = 0;                                       // static phase over 2 pi
  double length = 0;                                      // m, optical
  std::span<PhaseSensitivity const> phase_sensitivities;  // in the table
  std::uint32_t route = 0, record = 0;
  std::uint32_t beam = beam_of_port;  // as PathRecord::beam
  std::span<PhaseSensitivity const> amplitude_levers{};
};

struct PathChoice {
  std::vector<std::uint32_t> routes;  // positions in CouplingTable::classes
  std::size_t per_route = 0;          // fields per route; 0: one for each record
  std::uint64_t seed = 1;
  std::uint32_t realisation = 0;
  // By route, rad: such a route is one field of this static phase, one of its paths drawn by weight. Empty: none is
  // known.
  std::vector<std::optional<double>> phases{};
};

// Fields whose mean powers sum, route by route, to C_rev times the mean coupling times the copies of the port.
// `per_route` below the number of records: so many of equal power, picked by systematic sampling with the chance of
// their weights (deterministic routes always keep all). Static phases are uniform, a function of seed, realisation,
// route and address of the record, and copy (docs/theory/path_integral.md): one realisation of the speckle. Copies of a
// port have the same motion. The paths of a coherent family have the phases of their fields, and one common phase per
// principal state of polarisation and realisation (eq. 10.5).
std::vector<StrayPath> stray_paths(CouplingTable const&, Interferometer const&, PathChoice const&);

// `half_path`: each path sees the motion delayed by half of its optical length, to first order in the delay
// (docs/theory/phase.md, eq. 2.6); `by_hit`: each hit by its own delay (docs/theory/time_domain.md, eq. N.29).
enum class Delay : std::uint8_t { none, half_path, by_hit };
// Input of phase_sum, for paths of one motion; coordinates that move none of them are left out. Not `by_hit`: that is
// the motion of with_delays().
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

// Eq. 7.13: rate > 2 (fringe + margin). The margin is a quarter of the largest fringe frequency, for the tails of the
// spectrum beyond it (J_n(z) for n > z), and at least the highest frequency of the motion.
struct SamplingRule {
  double fringe = 0, margin = 0;  // Hz
  double least() const { return 2 * (fringe + margin); }
  double automatic() const;  // Hz: the smallest power of two above that and above five times the fringe, from 1024
};

struct TimeDomainSettings {
  PathChoice paths;
  double start = 0;                    // GPS s
  double duration = 0;                 // s
  double rate = 0;                     // Hz; 0: by the rule, from realisation 0
  double band_low = 3, band_high = 0;  // Hz, where responses are used, h(t) is zero elsewhere; high 0: up to rate/2
  Delay delay = Delay::none;           // `by_hit` needs band_high
  unsigned threads = 0;                // 0: all cores; the same bits for any number
  DirectSum direct;                    // see phase_sum.hpp
  SumProgress progress;                // completed share of the sums over paths, port after port
};

struct PortField {
  PortId port;
  std::vector<std::complex<double>> field;  // s(t), relative to the main field
};

struct StrayLight {
  SampleTimes times;
  std::vector<double> h;          // strain
  std::vector<PortField> fields;  // of the ports that have paths, all copies
  MotionSeries motion;            // drawn
  std::size_t paths = 0;          // fields summed
  SamplingRule rule;
  FastestFringe fastest;
  std::string fastest_route;
  MovingRoute moving;
  std::string moving_route;
  double longest_delay = 0;  // s, of light on these paths
};

// Throws InputError when the given rate is too low (with the path and the rate it needs), when a recording does not
// cover the time, when no path is selected; NumericalError when the automatic rate would pass 2^20 Hz.
StrayLight stray_light(CouplingTable const&, MotionSet const&, Interferometer const&, TimeDomainSettings const&);

// s(t) of each port that has paths.
std::vector<PortField> stray_fields(std::span<StrayPath const>, MotionSeries const&, Delay = Delay::none,
                                    unsigned threads = 0, DirectSum const& = {}, SumProgress const& progress = {});

// h = T_ph * Im s + T_am * Re s (eq. 1.13), in the band; responses act on one period that is closed smoothly, so the
// first and last 1/band_low affect each other.
std::vector<double> strain(std::span<PortField const>, Interferometer const&, double rate, double band_low,
                           double band_high);

// Size of the effects neglected by frozen geometry (eq. 2.6).
// Phase [rad] of a transverse motion of this size [m] seen from this distance [m].
double second_order_phase(double motion, double distance, double wavelength);
// Phase [rad] that the path from one point to another over a flat mirror loses when the mirror turns by this angle
// [rad] in the plane of incidence about the point it is hit at, so far [m] from both (eq. N.28). To first order the
// length of a specular path is stationary.
double ray_tilt_phase(double angle, double before, double after, double wavelength);
// Phase error [cycles] at frequency hz of light that takes this path [m].
double delay_cycles(double hz, double path_length);

}  // namespace straytrace::noise
