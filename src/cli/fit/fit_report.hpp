// SPDX-License-Identifier: BSD-3-Clause
// Options of the fits of fringes, and a fit as text, JSON and plots.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

#include "analysis/fringes/fringe_fit.hpp"
#include "cli/data_options.hpp"
#include "session/records/route_predictions.hpp"

namespace straytrace::cli {

// A fit as text, JSON and plots.

// Options of `straytrace fit` and `fit edge`, and the records and ranges that follow from them.

struct FitOptions {
  DataOptions data;
  PredictedRoutes prediction;  // without a run: fit data alone
  std::string target, target_unit, witness, witness2, witness_unit, witness2_unit, corner;
  std::string wavelength, multiplicity, delay, drift, ratio, gain;
  std::vector<std::string> free;
  std::optional<std::size_t> paths;  // without a run
  std::string train = "70 %", method = "frequency", false_alarm = "1e-3", subtract;
  std::string stride = "10 s", segment = "1 s", factor = "0.2..3";  // of `edge`
};

// The records in SI units, within --gps: velocities and accelerations integrated behind the high pass of --corner.
FringeRecords records_of(FitOptions const&);
// "1..6", "-20 ms..20 ms", or one value. InputError names the option.
SearchRange option_range(std::string const& text, Dimension, std::string const& option, std::string const& example);
CLI::Validator is_range(Dimension, std::string const& option, std::string const& example);
double option_share(std::string const& text, std::string const& option, std::string const& example);  // above 0, to 1
double strain_per_field(std::string const& text);  // of --gain-per-field
// Common options of a fit of phases and one of edges: band (required), wavelength, and ratio of the second witness.
struct FitGround {
  double low = 0, high = 0, wavelength = 0;  // Hz; m
  SearchRange ratio;
};
FitGround ground_of(FitOptions const&, FringeRecords const&);
FringeFitSettings settings_of(FitOptions const&, FringeRecords const&, std::vector<RoutePrediction> const&);

void add_record_options(CLI::App&, FitOptions&);  // --target ... --gps, --wavelength, --ratio
void add_fit_edge(CLI::App& fit, int& exit_code);
void add_fit_baffle(CLI::App& fit, int& exit_code);

struct FitAnswer {
  FringeRecords const& records;
  FringeFitSettings const& settings;
  std::vector<RoutePrediction> const& routes;
  FringeFit const& fit;
  bool field = false;  // amplitudes are relative fields, sqrt(f_r); otherwise in units of the target
};

std::string verdict_text(FitOutcome);  // "fringe noise found: it predicts the rest of the record"
std::string fit_text(FitAnswer const&);
nlohmann::json fit_json(FitAnswer const&);
// ASD of the target, of the fitted noise and, where the outcome allows, of the residual.
CurveSheet fit_curves(FitAnswer const&, FringeModel const&);
// Target less model; throws InputError when the outcome does not allow it.
TimeSeries subtracted(FitAnswer const&, FringeModel const&);

}  // namespace straytrace::cli
