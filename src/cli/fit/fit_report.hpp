// SPDX-License-Identifier: BSD-3-Clause
// A fit as text, JSON and plots.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

#include "cli/fit/fit_options.hpp"

namespace straytrace::cli {

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
