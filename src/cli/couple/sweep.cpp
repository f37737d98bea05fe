// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple sweep: coupling along the ridge of a swept drive.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "analysis/coupling/lines.hpp"
#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "cli/couple/couple.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"

namespace straytrace::cli {
namespace {

struct SweepOptions {
  DataOptions data;
  PairOptions pair;
  std::string window = "2 s", resolution, save;
  RidgeSettings ridge;
  std::size_t show = 12;
};

std::string text_of(CouplingFunction const& c, std::size_t windows, std::size_t show) {
  std::vector<double> heights;
  std::size_t measured = 0, limits = 0;
  for (CouplingPoint const& p : c.points) {
    heights.push_back(p.flag == CouplingFlag::measured ? p.factor : 0);
    measured += p.flag == CouplingFlag::measured;
    limits += p.flag == CouplingFlag::upper_limit;
  }
  std::vector<CouplingPoint> peaks;
  for (std::size_t const i : peaks_of(heights)) peaks.push_back(c.points[i]);
  std::string text = fmt::format("{}: {}, {} measured, {}\n", c.witness, counted(windows, "window"),
                                 measured == 1 ? "1 frequency" : fmt::format("{} frequencies", measured),
                                 counted(limits, "upper limit"));
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](CouplingPoint const& a, CouplingPoint const& b) { return a.factor > b.factor; });
  Columns table{{"frequency", "coupling [" + c.unit + "]", "significance", "coherence"}, {}, {}};
  for (std::size_t i = 0; i < std::min(show, peaks.size()); ++i)
    table.rows.push_back({fmt::format("{:.5g} Hz", peaks[i].hz), plus_minus(peaks[i].factor, peaks[i].sigma),
                          fmt::format("{:.1f}", peaks[i].significance), fmt::format("{:.2f}", peaks[i].coherence)});
  return table.rows.empty() ? text + "no response of the target\n" : text + aligned(table);
}

int run_sweep(SweepOptions o) {
  check_outputs(o.data);
  if (o.data.band.empty())
    throw InputError("--band is missing: the range of the sweep", "write --band \"20 Hz..100 Hz\"");
  FrequencyBand const band = option_band(o.data.band, "--band");
  o.ridge.low = band.low;
  o.ridge.high = band.high;
  o.ridge.window = option_quantity(o.window, dim::time, "--window", "2 s");
  ChannelPair const pair = read_pair(o.pair, span_of(o.data));
  std::vector<RidgePoint> ridge = ridge_coupling(pair.witness, pair.target, o.ridge);
  ToMetres const metres = to_metres(o.pair.displacement, pair.witness.unit);
  in_metres(metres, ridge);
  double const resolution =
      o.resolution.empty() ? 2 / o.ridge.window : option_quantity(o.resolution, dim::frequency, "--resolution", "1 Hz");
  TimeSeries witness = pair.witness;
  witness.unit = metres.unit;
  CouplingFunction const c = coupling_of_ridge(ridge, witness, pair.target, resolution, o.ridge.significance);
  CurveSheet sheet;
  sheet.title = fmt::format("coupling of {} to {} along a sweep", c.witness, c.target);
  sheet.notes = {source_note(pair.witness), source_note(pair.target),
                 fmt::format("Hann windows of {:g} s, half overlap; upper limits: 95 %", o.ridge.window)};
  sheet.x = {"frequency", "Hz", {}};
  for (CouplingPoint const& p : c.points) sheet.x.values.push_back(p.hz);
  sheet.y = coupling_columns(c, "");
  answer(o.data, sheet, text_of(c, ridge.size(), o.show));
  save_coupling(o.save, c, o.data.quiet);
  return 0;
}

}  // namespace

void add_couple_sweep(CLI::App& couple, int& exit_code) {
  auto* const command = couple.add_subcommand("sweep", "Measure the coupling along the ridge of a swept drive.");
  auto const options = std::make_shared<SweepOptions>();
  SweepOptions& o = *options;
  add_pair_options(*command, o.pair, "FILE::CHANNEL of the drive: motion, force or sound");
  add_band_option(*command, o.data, "LOW..HIGH searched for the drive");
  add_gps_options(*command, o.data.gps, o.data.segments);
  command->add_option("--window", o.window, "length of the windows")->default_str(o.window);
  command->add_option("--resolution", o.resolution, "resolution of the coupling; default: 2 over the window");
  add_ratio_option(*command, "--witness-ratio", o.ridge.witness_ratio, "amplitude of the drive over the background");
  add_significance_option(*command, o.ridge.significance, "significance of the target; below: an upper limit");
  command->add_option("--show", o.show, "rows of the table")->default_str("12")->check(whole_between(1, 1e6, "20"));
  mark_output(*command, *command->add_option("--save", o.save, "CSV of pemcoupling, for straytrace project"));
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple sweep --witness examples/data/sweep.csv::MIC --target examples/data/sweep.csv::H --band "
      "\"10 Hz..45 Hz\" --window \"1 s\"\n"
      "  straytrace couple sweep --witness examples/data/sweep.csv::MIC --target examples/data/sweep.csv::H --band "
      "\"10 Hz..45 Hz\" --window \"1 s\" --save mic.csv -o sweep.png");
  command->callback([options, &exit_code] { exit_code = run_sweep(*options); });
}

}  // namespace straytrace::cli
