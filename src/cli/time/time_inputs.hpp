// SPDX-License-Identifier: BSD-3-Clause
// Common inputs of `project` and `fringes`: a run, motion replaced by measured channels, the stretch of time, and
// routes.
#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

#include "motion/series_motion.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "results/results.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {

struct TimeOptions {
  std::string run, motion, unit, gps, duration, corner;
  std::vector<std::string> body, axis, channel;
  std::vector<std::string> routes, ports, moved_by;
  std::uint64_t seed = 1;
  double rate = 0;            // Hz; 0: chosen
  std::size_t per_route = 0;  // 0: a number that limits the work
  std::string backend = "cpu";
  unsigned threads = 0;
  bool retarded = false;
};

void add_motion_options(CLI::App&, TimeOptions&);   // --motion, --body, --axis, --channel, --unit, --corner, --seed
void add_stretch_options(CLI::App&, TimeOptions&);  // --gps, --duration, --rate
void add_route_options(CLI::App&, TimeOptions&);    // --route, --port, --moved-by

struct TimeInputs : OpenRun {
  // Reads and chooses; all problems of the command line in one InputError where they do not depend on one another.
  explicit TimeInputs(TimeOptions const&);

  NoiseBudget exact;                  // with spectra of the motion
  std::vector<std::uint32_t> routes;  // chosen
  double start = 0, duration = 0;     // GPS s, s
  CouplingTable const& coupling() const { return file.trace.coupling; }
};

// The recording replaces all motion of this coordinate; other bodies keep theirs.
void replace_coordinate(MotionSet&, BodyId, int axis, RecordedMotion const&);

// Displacement [m] or angle [rad] from a channel of displacement, velocity or acceleration; the last two need a
// corner [Hz], below which motion is removed. InputError names the option.
RecordedMotion as_motion(TimeSeries const&, bool rotation, double corner_hz);

}  // namespace straytrace::cli
