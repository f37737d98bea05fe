// SPDX-License-Identifier: BSD-3-Clause
// A run whose motion is followed in time: channels that replace motion, the stretch of time, and routes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "noise/project/sensor_noise.hpp"
#include "noise/time_domain/phase_sum.hpp"
#include "scene/scene.hpp"
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

// The table `sensors` of a scene: sizes of the sensors on the beams of ports, and where their watts are counted.

// Problems go to the document of the scene. Names in the order of ids.
std::vector<Sensor> read_sensors(Scene const&, std::vector<std::string> const& ports,
                                 std::vector<std::string> const& receivers);

// One for each port of a run, in their order: those of the table, and else sensors larger than their beam. Throws where
// the table has problems. `power`: of the beam of each port, W; `main_power`: that of the main mode. 0: not stated.
std::vector<Sensor> sensors_of_ports(Scene const&, CouplingTable const&, std::vector<double> const& power,
                                     double main_power);

}  // namespace straytrace::session
