// SPDX-License-Identifier: BSD-3-Clause
// Options that `project` and `fringes` share: a run, motion that measured channels replace, the stretch of time,
// routes.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "results/curves/curve_file.hpp"
#include "session/records/time_inputs.hpp"

namespace straytrace::cli {

struct TimeOptions : TimeRequest {
  std::string gps, segments, duration_text, corner_text;  // as written
  std::uint64_t seed = 1;
  double rate = 0;  // Hz; 0: chosen
};

void add_motion_options(CLI::App&, TimeOptions&);   // --motion, --body, --axis, --channel, --unit, --corner, --seed
void add_stretch_options(CLI::App&, TimeOptions&);  // --gps, --segments, --duration, --rate
void add_route_options(CLI::App&, TimeOptions&);    // --route, --port, --moved-by
TimeRequest request_of(TimeOptions const&);

// Segments of one stride, half overlapping; ASD of the lines from low to high [Hz].
MapSheet spectrogram_of(TimeSeries const&, double stride, double low, double high);

}  // namespace straytrace::cli
