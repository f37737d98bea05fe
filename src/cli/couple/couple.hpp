// SPDX-License-Identifier: BSD-3-Clause
// Common parts of the subcommands of straytrace couple: channels in stretches, displacement, results.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

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

// A witness and a target with their units, over one stretch.
struct PairOptions {
  std::string witness, target, witness_unit, target_unit;
  bool displacement = false;
};
void add_pair_options(CLI::App&, PairOptions&, char const* witness);
// Thresholds, with the present value as the default: a ratio of amplitudes; --significance in standard deviations.
void add_ratio_option(CLI::App&, std::string const& name, double& ratio, std::string const& help);
void add_significance_option(CLI::App&, double& significance, std::string const& help);
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
std::string argument_in(StretchArgument const&, std::string const& channel, std::string const& option);

// "3.7e-14 ± 0.2e-14 1/m (C.13; ...)", with a hint where the band is too narrow.
std::string band_text(BandCoupling const&, std::string const& unit);

// Results that are not curves: stored with the curves, under "result".
void answer_with_result(DataOptions const&, CurveSheet const&, std::string const& text, nlohmann::json const& result);
// Columns coupling, its band and upper limits, for the points of a coupling; `prefix` before their names.
std::vector<CurveColumn> coupling_columns(CouplingFunction const&, std::string const& prefix);
void save_coupling(std::string const& file, CouplingFunction const&, bool quiet);  // CSV of pemcoupling
nlohmann::json number_or_null(double);
std::string plus_minus(double value, double sigma);  // "1.23e-9 ± 0.04e-9"; bare without an error

}  // namespace straytrace::cli
