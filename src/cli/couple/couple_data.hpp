// SPDX-License-Identifier: BSD-3-Clause
// Common parts of the subcommands of straytrace couple: channels in stretches, displacement, results.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/coupling/band_coupling.hpp"
#include "analysis/coupling/coupling.hpp"
#include "analysis/coupling/lines.hpp"
#include "cli/data_options.hpp"

namespace CLI {
class App;
}

namespace straytrace::cli {

// Each adds its own subcommand to `couple`.
void add_couple_noise(CLI::App& couple, int& exit_code);
void add_couple_taps(CLI::App& couple, int& exit_code);
void add_couple_lines(CLI::App& couple, int& exit_code);
void add_couple_ramp(CLI::App& couple, int& exit_code);
void add_couple_sweep(CLI::App& couple, int& exit_code);
void add_couple_impulse(CLI::App& couple, int& exit_code);
void add_couple_events(CLI::App& couple, int& exit_code);
void add_couple_predict(CLI::App& couple, int& exit_code);

// -o, --format, and --silent for results only: `--quiet` names the stretch without injection.
void add_couple_outputs(CLI::App&, DataOptions&);

// A witness and a target with their units, over one stretch.
struct PairOptions {
  std::string witness, target, witness_unit, target_unit;
  bool displacement = false;
};
void add_pair_options(CLI::App&, PairOptions&, char const* witness);
struct ChannelPair {
  TimeSeries witness, target;  // on equal samples
};
ChannelPair read_pair(PairOptions const&, GpsSpan);

// "A..B", "FILE", "FILE@A..B", "FILE::CHANNEL", "FILE::CHANNEL@A..B": where an injection is.
struct StretchArgument {
  std::string file, channel;
  GpsSpan span;
};
StretchArgument parse_stretch(std::string const& text, std::string const& option);
// "FILE::CHANNEL", or a channel of the file that the stretch names.
TimeSeries channel_in(StretchArgument const&, std::string const& channel, std::string const& unit,
                      std::string const& option);

// A stretch as found in a record. Two stretches must not overlap: quiet data would contain the injection, or one
// injection would count twice. Records of different files share their time only where that is GPS.
struct FoundStretch {
  std::string name, file;   // "--quiet 0..24"
  double from = 0, to = 0;  // GPS s
};
void refuse_overlaps(std::vector<FoundStretch> const&);

// Conversion of a witness to metres: divide by (2 pi f)^times.
struct ToMetres {
  int times = 0;
  double scale = 1;  // of its unit to SI
  std::string unit;  // "m", or the original unit
};
ToMetres to_metres(bool displacement, std::string const& unit);
double factor_at(ToMetres const&, double hz);
void in_metres(ToMetres const&, std::vector<LinePoint>&);

// "3.7e-14 ± 0.2e-14 1/m (C.13; ...)", with a hint where the band is too narrow.
std::string band_text(BandCoupling const&, std::string const& unit);

// Results that are not curves: stored with the curves, under "result".
void answer_with_result(DataOptions const&, CurveSheet const&, std::string const& text, nlohmann::json const& result);
// Columns coupling, its band and upper limits, for the points of a coupling; `prefix` before their names.
std::vector<CurveColumn> coupling_columns(CouplingFunction const&, std::string const& prefix);
void save_coupling(std::string const& file, CouplingFunction const&, bool quiet);  // CSV of pemcoupling
nlohmann::json number_or_null(double);
std::string plus_minus(double value, double sigma);  // "1.23e-9 ± 0.04e-9"; bare without an error

// A driven line in witness and target: input of `couple lines` and `couple ramp`.

struct LineOptions {
  DataOptions data;
  PairOptions pair;
  std::string window = "4 s", wavelength = "1064 nm", save;
  double multiplicity = 1, z_max = 20, significance = 3;
  int harmonics = 5;
};
void add_line_options(CLI::App&, LineOptions&);  // all but --harmonics, --save, --significance and outputs

struct Driven {
  ChannelPair pair;
  std::vector<LinePoint> drive, target;  // drive in `unit`
  double window = 0, wavelength = 0;     // s, m
  std::string unit, coupling_unit;

  double frequency() const;  // Hz, mean
};
Driven follow_drive(LineOptions const&);
// Frequency, drive and target against time.
CurveSheet line_sheet(Driven const&);

}  // namespace straytrace::cli
