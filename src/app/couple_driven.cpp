// SPDX-License-Identifier: BSD-3-Clause
#include "app/couple_driven.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>

#include "base/message.hpp"

namespace straytrace {

void add_line_options(CLI::App& command, LineOptions& o) {
  add_pair_options(command, o.pair, "FILE::CHANNEL of the drive: motion, force or sound");
  add_band_option(command, o.data, "LOW..HIGH where the line of the drive is: \"18 Hz..22 Hz\"");
  command.add_option("--gps", o.data.gps, "stretch A..B in GPS seconds or UTC; default: all");
  command.add_option("--window", o.window, "length of the windows")->default_str(o.window);
  command.add_option("--wavelength", o.wavelength, "of the light")->default_str(o.wavelength);
  command.add_option("--multiplicity", o.multiplicity, "bounces off what moves: phase over 4 pi x/lambda")
      ->default_str("1")
      ->check(CLI::Range(1e-3, 1e6));
  command.add_option("--z-max", o.z_max, "largest phase amplitude that is looked for, rad")
      ->default_str("20")
      ->check(CLI::Range(0.1, 1000.0));
}

Driven follow_drive(LineOptions const& o) {
  if (o.data.band.empty())
    throw InputError("error: --band is missing: where the line of the drive is\n  write --band \"18 Hz..22 Hz\"");
  FrequencyBand const band = option_band(o.data.band, "--band");
  Driven d;
  d.window = option_quantity(o.window, dim::time, "--window", "4 s");
  d.wavelength = option_quantity(o.wavelength, dim::length, "--wavelength", "1064 nm");
  d.pair = read_pair(o.pair, span_of(o.data));
  d.drive = track_line(d.pair.witness, {band.low, band.high, d.window});
  d.target = follow_line(d.pair.target, d.drive, d.window);
  ToMetres const metres = to_metres(o.pair.displacement, d.pair.witness.unit);
  in_metres(metres, d.drive);
  d.unit = metres.unit;
  d.coupling_unit = coupling_unit(d.pair.target.unit, d.unit);
  return d;
}

double Driven::frequency() const {
  double sum = 0;
  for (LinePoint const& p : drive) sum += p.hz / double(drive.size());
  return sum;
}

CurveSheet line_sheet(Driven const& d) {
  CurveSheet sheet;
  sheet.title = fmt::format("line of {} in {}", d.pair.witness.name, d.pair.target.name);
  sheet.notes = {source_note(d.pair.witness), source_note(d.pair.target),
                 fmt::format("Hann windows of {:g} s, half overlap; amplitudes are peak", d.window)};
  sheet.x = {"time", "s", {}};
  sheet.log_x = false;
  CurveColumn hz{"frequency", "Hz", {}, "hidden"}, drive{"drive", d.unit, {}, "hidden"},
      target{"target", d.pair.target.unit, {}}, sigma{"target_sigma", d.pair.target.unit, {}, "hidden"};
  for (std::size_t i = 0; i < d.drive.size(); ++i) {
    sheet.x.values.push_back(d.drive[i].time);
    hz.values.push_back(d.drive[i].hz);
    drive.values.push_back(std::abs(d.drive[i].amplitude));
    target.values.push_back(std::abs(d.target[i].amplitude));
    sigma.values.push_back(d.target[i].sigma);
  }
  sheet.y = {hz, drive, target, sigma};
  return sheet;
}

}  // namespace straytrace
