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

// Measured recoupled fraction over the predicted mean, and whether one speckle explains it.
struct AgainstPrediction {
  Fitted fraction, ratio;
  double low = 0, high = 0;  // of the ratio, 5 and 95 % of one speckle (eq. 10.2); 0, 0: no speckle
  bool within = false;       // with two standard errors of the ratio
};
AgainstPrediction against(FittedPath const&, RoutePrediction const&);

std::string verdict_text(FitOutcome);  // "fringe noise found: it predicts the rest of the record"
// Largest excursion of W (x_1 - ratio x_2) of a path from the middle of its range, m: a peak amplitude. Its error is
// that of W and ratio together.
Fitted effective_peak(FitAnswer const&, std::size_t path);
// rad rms of the phase of a path right below --corner, which the integrated witnesses lack but the light senses:
// amplitudes come out low by exp(-phase^2/2). NaN where the record is too short to tell.
double unseen_phase(FitAnswer const&, std::size_t path);
std::string fit_text(FitAnswer const&);
nlohmann::json fit_json(FitAnswer const&);
// ASD of the target, of the fitted noise and, where the outcome allows, of the residual.
CurveSheet fit_curves(FitAnswer const&, FringeModel const&);
// Target less model; throws InputError when the outcome does not allow it.
TimeSeries subtracted(FitAnswer const&, FringeModel const&);

}  // namespace straytrace::cli
