// SPDX-License-Identifier: BSD-3-Clause
// straytrace fit: fringe noise in a measured h(t) from a measured motion.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/fit/fit_report.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"

namespace straytrace {
namespace {

constexpr char before_subtraction[] =
    "compare with h(t) before noise subtraction: a subtraction of the witness has taken the fringes, or made others\n";

bool is_json(std::string const& file) { return file.ends_with(".json"); }

std::vector<double> const& values_of(CurveSheet const& sheet, std::size_t i) { return sheet.y[i].values; }

// Results and curves in one file.
std::string file_json(FitAnswer const& answer, CurveSheet const& curves) {
  nlohmann::json out = fit_json(answer);
  out["asd"]["frequency_hz"] = curves.x.values;
  for (std::size_t i = 0; i < curves.y.size(); ++i) out["asd"][curves.y[i].name] = values_of(curves, i);
  return out.dump(1) + "\n";
}

void write_fit(FitOptions const& o, FitAnswer const& answer, FringeModel const& model) {
  CurveSheet const curves = fit_curves(answer, model);
  DataOptions others = o.data;
  others.out.clear();
  for (std::string const& file : o.data.out) {
    if (!is_json(file)) {
      others.out.push_back(file);
      continue;
    }
    write_file(file, file_json(answer, curves));
    if (!o.data.quiet) std::cerr << fmt::format("wrote {}\n", file);
  }
  write_outputs(others, curves);
}

int fit(FitOptions const& o) {
  check_outputs(o.data);
  if (!o.subtract.empty() && !o.subtract.ends_with(".hdf5") && !o.subtract.ends_with(".h5"))
    throw InputError(fmt::format("--subtract: '{}' does not end in .hdf5", o.subtract),
                     "the residual is written as gwpy reads it");
  if (!o.run.empty() && !o.gain.empty())
    throw InputError("--gain-per-field: the run has the responses of its ports", "leave one of the two out");
  FringeRecords const records = records_of(o);
  std::vector<RoutePrediction> const routes = predictions(o, is_rotation(records));
  FringeFitSettings const settings = settings_of(o, records, routes);
  FringeFit const result = fit_fringes(records, settings);
  FitAnswer const answer{records, settings, routes, result, !o.run.empty() || !o.gain.empty()};
  if (o.data.json())
    std::cout << fit_json(answer).dump(1) << '\n';
  else
    std::cout << fit_text(answer);
  if (!o.data.quiet) std::cerr << before_subtraction;
  if (o.data.out.empty() && o.subtract.empty()) return done;
  FringeModel const model = fringe_model(records, settings, result);
  if (!o.data.out.empty()) write_fit(o, answer, model);
  if (!o.subtract.empty()) {
    TimeSeries const rest = subtracted(answer, model);
    write_file(o.subtract, series_hdf5({&rest, 1}));
    if (!o.data.quiet) std::cerr << fmt::format("wrote {}\n", o.subtract);
  }
  return done;
}

}  // namespace

void add_fit(CLI::App& app, int& exit_code) {
  auto* const command = app.add_subcommand(
      "fit", "Fit fringe noise in a measured h(t): recoupled fraction, phase, effective motion and residual.");
  auto const options = std::make_shared<FitOptions>();
  FitOptions& o = *options;
  command->add_option("run", o.run, "run file whose routes are fitted and compared; none: the data alone");
  add_record_options(*command, o);
  command->add_option("--path", o.rows, "rows of the path table of the run, 1 unless given; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--body", o.body, "that the witness is of; default: the one that moves the path most");
  command
      ->add_option(
          "--axis", o.axis,
          "of the body that the witness measures: x, y, z, or rx, ry, rz of an angle; default: that of most phase")
      ->check(CLI::IsMember({"x", "y", "z", "rx", "ry", "rz"}));
  command->add_option("--paths", o.paths, "number of paths, without a run")->check(whole_between(1, 6, "2"));
  command->add_option("--multiplicity", o.multiplicity,
                      "W in units of 4 pi/lambda: a value, or the range that is searched; 0.5..6 unless given; of an "
                      "angle a length");
  command->add_option("--delay", o.delay, "of the noise behind the witness: a value, or a range -20 ms..20 ms");
  command->add_option("--drift", o.drift, "of the static phase: a value, or a range \"-1 rad/s..1 rad/s\"");
  command
      ->add_option(
          "--free", o.free,
          "parameters searched as well, over their default ranges: multiplicity,phase,delay,drift,ratio; amplitude and "
          "phase are always free")
      ->delimiter(',')
      ->check(CLI::IsMember({"multiplicity", "phase", "delay", "drift", "ratio"}));
  command->add_option("--gain-per-field", o.gain, "strain per relative field, of a detector without run: \"1.1e-16\"");
  command->add_option("--train", o.train, "share of the record that is fitted; the rest tests the fit")
      ->default_str(o.train);
  command->add_option("--method", o.method, "frequency: likelihood on lines; time: least squares of whitened samples")
      ->check(CLI::IsMember({"frequency", "time"}))
      ->default_str(o.method);
  command
      ->add_option("--false-alarm", o.false_alarm,
                   "chance of noise alone up to which a fringe is significant, in the search and in the rest")
      ->default_str(o.false_alarm);
  command->add_option("--subtract", o.subtract, "file for target less fitted noise (gwpy HDF5), in the band");
  add_fit_edge(*command, exit_code);
  command->footer(
      "Examples:\n"
      "  straytrace fit --target examples/data/swinging_baffle.hdf5::h --witness examples/data/swinging_baffle.hdf5::x "
      "--band \"20 Hz..85 Hz\"\n"
      "  straytrace fit --target examples/data/swinging_baffle.hdf5::h --witness examples/data/swinging_baffle.hdf5::x "
      "--band \"20 Hz..85 Hz\" --multiplicity 1..2 --gain-per-field 1.1e-16 --subtract residual.hdf5 -o fit.html");
  command->callback([options, command, &exit_code] {
    if (command->get_subcommands().empty()) exit_code = fit(*options);
  });
}

}  // namespace straytrace
