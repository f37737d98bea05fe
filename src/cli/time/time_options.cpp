// SPDX-License-Identifier: BSD-3-Clause
#include "cli/time/time_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/files/unit_text.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {

void add_motion_options(CLI::App& command, TimeOptions& o) {
  command.add_option("--motion", o.motion, "YAML file with 'straytrace: 1' and 'bodies' to use instead of the run's");
  command.add_option("--body", o.body, "body whose motion the next --channel replaces; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--axis", o.axis, "coordinate of that body: x, y, z, rx, ry or rz; may be repeated")
      ->allow_extra_args(false);
  command
      .add_option("--channel", o.channel, "FILE or FILE::CHANNEL with the motion of that coordinate; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--unit", o.unit, "unit of the channels, where the files have none: um, m/s^2");
  command.add_option("--corner", o.corner_text,
                     "high pass of integrated velocities and accelerations, for example 0.05Hz");
  command.add_option("--seed", o.seed, "seed of drawn motion and of static phases")->check(whole_between(0, 9e15, "7"));
}

void add_stretch_options(CLI::App& command, TimeOptions& o) {
  add_gps_options(command, o.gps, o.segments, "all recorded data");
  command.add_option("--duration", o.duration_text, "duration of the record; default: all recorded data, or 64 s");
  command.add_option("--rate", o.rate, "samples per second; default: chosen from the largest fringe frequency")
      ->check(number_between(1.0, 1048576.0, "4096"));
}

void add_route_options(CLI::App& command, TimeOptions& o) {
  command
      .add_option("--route", o.routes,
                  "only this route: rank in the path table or part of the name ('tube.S'); may be repeated")
      ->allow_extra_args(false);
  command.add_option("--port", o.ports, "only routes of this port; may be repeated")->allow_extra_args(false);
  command.add_option("--moved-by", o.moved_by, "only routes moved by this body; may be repeated")
      ->allow_extra_args(false);
}

TimeRequest request_of(TimeOptions const& o) {
  if (!o.unit.empty() && o.channel.empty())
    throw InputError("--unit: no --channel has samples of this unit", "remove it, or give a --channel");
  TimeRequest r = o;
  r.span = requested_span(o.gps, o.segments);
  if (!o.duration_text.empty()) r.duration = option_quantity(o.duration_text, dim::time, "--duration", "64 s");
  if (!o.corner_text.empty()) r.corner = option_quantity(o.corner_text, dim::frequency, "--corner", "0.05 Hz");
  return r;
}

MapSheet spectrogram_of(TimeSeries const& series, double stride, double low, double high) {
  Spectrogram const s = overlapping_spectrogram(series, stride);
  MapSheet map{fmt::format("spectrogram of {}", series.name),
               asd_unit(series.unit),
               {fmt::format("Hann segments of {:g} s, half overlapping; ASD, one-sided", stride)},
               s.time,
               {},
               {},
               {},
               {}};
  auto const inside = [&](double hz) { return hz >= low && hz <= high; };
  std::copy_if(s.hz.begin(), s.hz.end(), std::back_inserter(map.frequency), inside);
  for (std::size_t i = 0; i < s.time.size(); ++i)
    for (std::size_t k = 0; k < s.hz.size(); ++k)
      if (inside(s.hz[k])) map.value.push_back(s.at(i, k));
  return map;
}

}  // namespace straytrace::cli
