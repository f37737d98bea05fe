// SPDX-License-Identifier: BSD-3-Clause
// straytrace fit: fringe noise in a measured h(t) from a measured motion.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <iostream>
#include <memory>

#include "analysis/fringes/shelf_edge.hpp"
#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/fit/fit_report.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"
#include "spectra/files/gps.hpp"

namespace straytrace::cli {
namespace {

constexpr char before_subtraction[] =
    "compare with h(t) before noise subtraction: subtraction of the witness removes fringes or adds new ones\n";

bool is_json(std::string const& file) { return file.ends_with(".json"); }

std::vector<double> const& values_of(CurveSheet const& sheet, std::size_t i) { return sheet.y[i].values; }

// Results and curves in one file.
std::string file_json(FitAnswer const& answer, CurveSheet const& curves) {
  nlohmann::json out = fit_json(answer);
  out["asd"]["frequency_hz"] = curves.x.values;
  for (std::size_t i = 0; i < curves.y.size(); ++i) out["asd"][curves.y[i].name] = values_of(curves, i);
  return json_text(out, 1) + "\n";
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
                     "the residual is HDF5 for gwpy");
  if (!o.prediction.run.empty() && !o.gain.empty())
    throw InputError("--gain-per-field: the run has the responses of its ports", "remove one of the two");
  PredictedRoutes const& wanted = o.prediction;
  if (wanted.run.empty() && (!wanted.rows.empty() || !wanted.body.empty() || !wanted.axis.empty()))
    throw InputError("--path, --body and --axis choose from a run, but none is given",
                     "name the run file, or remove them");
  if (!wanted.run.empty() && o.paths)
    throw InputError("--paths is the number of paths of a fit without a run, but a run is given",
                     "choose paths of the run with --path, once for each, or remove the run");
  FringeRecords const records = records_of(o);
  std::vector<RoutePrediction> routes;
  if (!o.prediction.run.empty()) routes = route_predictions(o.prediction, is_rotation(records));
  FringeFitSettings const settings = settings_of(o, records, routes);
  FringeFit const result = fit_fringes(records, settings);
  FitAnswer const answer{records, settings, routes, result, !o.prediction.run.empty() || !o.gain.empty()};
  if (o.data.json())
    std::cout << json_text(fit_json(answer), 1) << '\n';
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

// Of --multiplicity: a length where the witness is an angle, which only its file tells.
void number_or_length(std::string const& text) {
  try {
    option_range(text, dim::length, "--multiplicity", "1 mm..5 cm");
  } catch (InputError const&) {
    option_range(text, dim::plain, "--multiplicity", "0.5..6");
  }
}

}  // namespace

void add_fit(CLI::App& app, int& exit_code) {
  auto* const command = app.add_subcommand(
      "fit", "Fit fringe noise in a measured h(t): recoupled fraction, phase, effective motion and residual.");
  auto const options = std::make_shared<FitOptions>();
  FitOptions& o = *options;
  command->add_option("run", o.prediction.run,
                      "run file whose routes are fitted and compared; without it, fit only the data");
  add_record_options(*command, o);
  command->add_option("--path", o.prediction.rows, "row of the path table of the run; default 1; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--body", o.prediction.body, "body of the witness; default: the one that moves the path most");
  command
      ->add_option(
          "--axis", o.prediction.axis,
          "coordinate measured by the witness: x, y, z, or rx, ry, rz for an angle; default: the one with most phase")
      ->check(CLI::IsMember({"x", "y", "z", "rx", "ry", "rz"}));
  command->add_option("--paths", o.paths, "number of paths, without a run")->check(whole_between(1, 6, "2"));
  command
      ->add_option("--multiplicity", o.multiplicity,
                   "W in units of 4 pi/lambda: a value, or the range to search; default 0.5..6; for an angle a length")
      ->check(readable(number_or_length));
  command->add_option("--delay", o.delay, "delay of the noise after the witness: a value, or a range -20 ms..20 ms")
      ->check(is_range(dim::time, "--delay", "-20 ms..20 ms"));
  command->add_option("--drift", o.drift, "drift of the static phase: a value, or a range \"-1 rad/s..1 rad/s\"")
      ->check(is_range(*times(dim::angle, dim::frequency), "--drift", "-1 rad/s..1 rad/s"));
  command
      ->add_option(
          "--free", o.free,
          "further parameters to search over their default ranges: multiplicity,phase,delay,drift,ratio; amplitude and "
          "phase are always free")
      ->delimiter(',')
      ->check(CLI::IsMember({"multiplicity", "phase", "delay", "drift", "ratio"}));
  command
      ->add_option("--gain-per-field", o.gain, "strain per relative field of the detector, without a run: \"1.1e-16\"")
      ->check(readable([](std::string const& text) { strain_per_field(text); }));
  command->add_option("--train", o.train, "share of the record that is fitted; the rest tests the fit")
      ->default_str(o.train)
      ->check(readable([](std::string const& text) { option_share(text, "--train", "70 %"); }));
  command->add_option("--method", o.method, "frequency: likelihood on lines; time: least squares of whitened samples")
      ->check(CLI::IsMember({"frequency", "time"}))
      ->default_str(o.method);
  command
      ->add_option("--false-alarm", o.false_alarm,
                   "largest false-alarm probability of a significant fringe, in the search and in the rest")
      ->default_str(o.false_alarm)
      ->check(readable([](std::string const& text) { option_share(text, "--false-alarm", "1e-3"); }));
  mark_output(*command, *command->add_option("--subtract", o.subtract,
                                             "file for the target minus the fitted noise (gwpy HDF5), in the band"));
  add_fit_edge(*command, exit_code);
  add_fit_baffle(*command, exit_code);
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

// straytrace fit edge: effective motion from the edge of the noise shelf.

namespace {

ShelfEdgeSettings edge_settings(FitOptions const& o, FringeRecords const& records) {
  FitGround const ground = ground_of(o, records);
  ShelfEdgeSettings s;
  s.low = ground.low;
  s.high = ground.high;
  s.wavelength = ground.wavelength;
  s.ratio = ground.ratio;
  s.stride = option_quantity(o.stride, dim::time, "--stride", "10 s");
  s.segment = option_quantity(o.segment, dim::time, "--segment", "1 s");
  s.factor = option_range(o.factor, multiplicity_dimension(records), "--factor",
                          is_rotation(records) ? "1 mm..5 cm" : "0.2..3");
  if (!(s.factor.low > 0 && s.factor.free()))
    throw InputError(fmt::format("--factor: '{}' is not a range above 0", o.factor), "write --factor 0.2..3");
  return s;
}

std::string stride_text(EdgeStride const& e) {
  std::string const start = fmt::format("  {:<16}{:>10.2f} Hz  ", gps_text(e.start), e.predicted);
  if (!e.significant) return start + "no edge inside the band\n";
  return start + fmt::format("{:<18}{:<18}{:.3g}\n",
                             with_error(e.factor.value * e.predicted, e.factor.sigma * e.predicted) + " Hz",
                             with_error(e.factor.value, e.factor.sigma), e.amplitude);
}

std::string edge_text(FringeRecords const& r, ShelfEdgeSettings const& s, ShelfEdgeFit const& fit) {
  std::string out = fmt::format("{} against {}, {:g} to {:g} Hz, {:g} nm: edges of {:g} s each\n", r.target.name,
                                r.witnesses[0].name, s.low, s.high, s.wavelength * 1e9, s.stride);
  if (r.witnesses.size() > 1)
    out += fmt::format("motion x_1 - ratio x_2, x_2 {}, ratio {}{}\n", r.witnesses[1].name,
                       fit.ratio.sigma > 0 ? with_error(fit.ratio.value, fit.ratio.sigma)
                                           : fmt::format("{:g} (fixed)", fit.ratio.value),
                       fit.ratio.at_end ? " (at the end of its range)" : "");
  out += fmt::format("  {:<16}{:>13}  {:<18}{:<18}{}\n", "GPS", "2 v_max/lambda", "edge", "factor",
                     "G [" + r.target.unit + "]");
  for (EdgeStride const& e : fit.strides) out += stride_text(e);
  if (fit.used == 0) return out + "no significant shelf edge\n";
  std::string const unit = is_rotation(r) ? " m" : "";
  return out + fmt::format("effective motion: {}{} times the witness, {} of {} strides, chi^2 {:.1f} about the mean\n",
                           with_error(fit.factor.value, fit.factor.sigma), unit, fit.used, fit.strides.size(),
                           fit.chi2);
}

nlohmann::json edge_json(ShelfEdgeSettings const& s, ShelfEdgeFit const& fit) {
  nlohmann::json strides = nlohmann::json::array();
  for (EdgeStride const& e : fit.strides) {
    nlohmann::json j{{"gps", e.start}, {"predicted_hz", e.predicted}, {"significant", e.significant}};
    if (e.significant) {
      j["factor"] = {{"value", e.factor.value}, {"sigma", e.factor.sigma}};
      j["amplitude"] = e.amplitude;
      j["gain"] = e.gain;
    }
    strides.push_back(j);
  }
  nlohmann::json out{{"band_hz", {s.low, s.high}},
                     {"wavelength_m", s.wavelength},
                     {"ratio", {{"value", fit.ratio.value}, {"sigma", fit.ratio.sigma}}},
                     {"strides", strides},
                     {"used", fit.used}};
  if (fit.used > 0)
    out["effective_motion"] = {{"value", fit.factor.value}, {"sigma", fit.factor.sigma}, {"chi2", fit.chi2}};
  return out;
}

CurveSheet edge_curves(std::string const& text, ShelfEdgeFit const& fit) {
  CurveSheet sheet;
  sheet.title = "shelf edges";
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    sheet.notes.push_back(text.substr(at, text.find('\n', at) - at));
  sheet.log_x = false;
  sheet.x = {"time", "s", {}, "line"};
  CurveColumn predicted{"predicted", "Hz", {}, "line"}, edge{"edge", "Hz", {}, "points"};
  CurveColumn sigma{"edge_sigma", "Hz", {}, "hidden"};
  for (EdgeStride const& e : fit.strides) {
    sheet.x.values.push_back(e.start);
    predicted.values.push_back(e.predicted);
    edge.values.push_back(e.significant ? e.factor.value * e.predicted : not_a_number);
    sigma.values.push_back(e.significant ? e.factor.sigma * e.predicted : not_a_number);
  }
  sheet.y = {predicted, edge, sigma};
  return sheet;
}

int edge(FitOptions const& o) {
  check_outputs(o.data);
  FringeRecords const records = records_of(o);
  ShelfEdgeSettings const settings = edge_settings(o, records);
  ShelfEdgeFit const fit = fit_shelf_edge(records, settings);
  std::string const text = edge_text(records, settings, fit);
  std::cout << (o.data.json() ? json_text(edge_json(settings, fit), 1) + "\n" : text);
  if (!o.data.out.empty()) write_outputs(o.data, edge_curves(text, fit));
  return done;
}

}  // namespace

void add_fit_edge(CLI::App& fit, int& exit_code) {
  auto* const command =
      fit.add_subcommand("edge", "Measure the effective motion from the shelf edge, stride by stride.");
  auto const options = std::make_shared<FitOptions>();
  FitOptions& o = *options;
  add_record_options(*command, o);
  command->add_option("--stride", o.stride, "length of a stretch, which gives one edge")
      ->default_str(o.stride)
      ->check(is_quantity(dim::time, "--stride", "10 s"));
  command
      ->add_option("--segment", o.segment,
                   "segment length of the spectra inside a stride; their resolution is 1/segment")
      ->default_str(o.segment)
      ->check(is_quantity(dim::time, "--segment", "1 s"));
  command
      ->add_option("--factor", o.factor,
                   "range of the effective motion over that of the witness; for an angle a length")
      ->default_str(o.factor);
  command->footer(
      "Examples:\n"
      "  straytrace fit edge --target examples/data/swinging_baffle.hdf5::h --witness "
      "examples/data/swinging_baffle.hdf5::x --band \"12 Hz..90 Hz\"\n"
      "  straytrace fit edge --target examples/data/swinging_baffle.hdf5::h --witness "
      "examples/data/swinging_baffle.hdf5::x --band \"12 Hz..90 Hz\" --stride \"5 s\" --factor 0.5..2");
  command->callback([options, &exit_code] { exit_code = edge(*options); });
}

}  // namespace straytrace::cli
