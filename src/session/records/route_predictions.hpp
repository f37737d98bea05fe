// SPDX-License-Identifier: BSD-3-Clause
// Predictions of a run next to measured records: for the routes of its path table, and for a measured strain.
#pragma once

#include <string>
#include <vector>

#include "analysis/fringes/fringe_fit.hpp"
#include "base/namespaces.hpp"
#include "spectra/welch.hpp"

namespace straytrace::session {

// Predictions of a run for the routes of its path table: coupling, fringes per metre of a body, response of the port.

// Prediction of a run for a route, for the witness of one body along one axis.
struct RoutePrediction {
  std::size_t rank = 0;
  std::string route, port, body, axis;
  double coupling = 0, sigma = 0;       // f_r, mean over the speckle, of one copy of the port; Monte-Carlo error
  bool speckle = true;                  // scattered light: one realisation varies; a ghost does not
  double multiplicity = 0, spread = 0;  // rms over the paths in units of 2k, m for a rotation; their standard deviation
  StrainResponse phase, amplitude;      // of its port; keep the model alive
};
// Rows of the path table of a run, 1 without any, and the body and axis of the witness: those of most phase where
// empty.
struct PredictedRoutes {
  std::string run, body, axis;
  std::vector<std::size_t> rows;
};
// Throws InputError when the run has no such row, detector or motion of that body, and for an axis that a witness of
// this kind, of an angle with `rotation`, does not measure.
std::vector<RoutePrediction> route_predictions(PredictedRoutes const&, bool rotation);

// Measured recoupled fraction over the predicted mean, and whether one speckle explains it.
struct AgainstPrediction {
  Fitted fraction, ratio;
  double low = 0, high = 0;  // of the ratio, 5 and 95 % of one speckle (eq. 10.2); 0, 0: no speckle
  bool within = false;       // with two standard errors of the ratio
};
AgainstPrediction against(FittedPath const&, RoutePrediction const&);

// A measured strain, drawn over the noise of a run.

struct MeasuredStrain {
  std::string name, source;       // in the legend; file, span and averages
  std::vector<double> hz, asd;    // 1/sqrt(Hz)
  std::vector<double> low, high;  // one standard error; NaN where it is not known
};

// Lines of an averaged spectrum of strain, joined to some 200 points per decade; their power is kept.
MeasuredStrain measured_from(WelchSpectrum const&, WelchSettings const&, double low_hz, double high_hz);
// Columns of text: frequency [Hz], ASD [1/sqrt(Hz)], and the standard error of the ASD where there is a third.
MeasuredStrain parse_measured(std::string const& text, std::string const& file, double low_hz, double high_hz);

std::string measured_json(std::vector<MeasuredStrain> const&);  // for pages and pictures

}  // namespace straytrace::session
