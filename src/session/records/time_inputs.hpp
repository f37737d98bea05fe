// SPDX-License-Identifier: BSD-3-Clause
// A run whose motion is followed in time: channels that replace motion, the stretch of time, and routes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "noise/time_domain/motion_series.hpp"
#include "session/open_run.hpp"
#include "spectra/series.hpp"

namespace straytrace::session {

struct TimeRequest {
  std::string run, motion, unit;                     // `motion`: a file, or empty; `unit`: of the channels
  std::vector<std::string> body, axis, channel;      // one of each for a coordinate; a single axis counts for all
  std::vector<std::string> routes, ports, moved_by;  // ranks or parts of names; names
  GpsSpan span;
  std::optional<double> duration, corner;  // s; Hz, high pass of channels that are integrated
};

struct TimeInputs : OpenRun {
  // Reads and chooses; throws InputError, which names the options of the command line.
  explicit TimeInputs(TimeRequest const&);

  NoiseBudget exact;                  // with spectra of the motion
  std::vector<std::uint32_t> routes;  // chosen
  double start = 0, duration = 0;     // GPS s, s
  CouplingTable const& coupling() const { return file.trace.coupling; }
};

// The motion drawn for fringe frequencies, at this rate in Hz; 0: a rate that suits the motion. With `channels` it
// contains recordings only: other motion would mask their fringes.
MotionSeries fringe_motion(TimeInputs&, bool channels, double rate, std::uint64_t seed);

}  // namespace straytrace::session
