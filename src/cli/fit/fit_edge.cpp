// SPDX-License-Identifier: BSD-3-Clause
// straytrace fit edge: effective motion from where the shelf of the noise ends.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <iostream>
#include <memory>

#include "analysis/fringes/shelf_edge.hpp"
#include "base/errors.hpp"
#include "cli/fit/fit_options.hpp"
#include "results/results.hpp"
#include "spectra/files/gps.hpp"

namespace straytrace {
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
  std::cout << (o.data.json() ? edge_json(settings, fit).dump(1) + "\n" : text);
  if (!o.data.out.empty()) write_outputs(o.data, edge_curves(text, fit));
  return done;
}

}  // namespace

void add_fit_edge(CLI::App& fit, int& exit_code) {
  auto* const command =
      fit.add_subcommand("edge", "Find the effective motion from where the shelf ends, stride by stride.");
  auto const options = std::make_shared<FitOptions>();
  FitOptions& o = *options;
  add_record_options(*command, o);
  command->add_option("--stride", o.stride, "length of each stretch that gives one edge")->default_str(o.stride);
  command->add_option("--segment", o.segment, "of the spectra inside a stride; their resolution is 1/segment")
      ->default_str(o.segment);
  command
      ->add_option("--factor", o.factor, "range of the effective motion over that of the witness; of an angle a length")
      ->default_str(o.factor);
  command->footer(
      "Examples:\n"
      "  straytrace fit edge --target examples/data/swinging_baffle.hdf5::h --witness "
      "examples/data/swinging_baffle.hdf5::x --band \"12 Hz..90 Hz\"\n"
      "  straytrace fit edge --target examples/data/swinging_baffle.hdf5::h --witness "
      "examples/data/swinging_baffle.hdf5::x --band \"12 Hz..90 Hz\" --stride \"5 s\" --factor 0.5..2");
  command->callback([options, &exit_code] { exit_code = edge(*options); });
}

}  // namespace straytrace
