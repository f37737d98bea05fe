// SPDX-License-Identifier: BSD-3-Clause
// BSDF models of three parameters fitted to measured points: ABg (docs/theory/surfaces.md, eq. 3.16), Harvey
// (eq. 3.14), and k-correlation by Rayleigh-Rice (eq. 3.13, 3.8), with a constant floor (eq. 3.18) where the points
// show one. One set of parameters for all incidences; least squares in ln(BSDF), with Huber's loss beyond 2.5 standard
// errors, and upper limits by the probability that the measured value lies below them. Also an audit of the points
// themselves (docs/reference/scatter/measured_files.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {

struct FitParameter {
  std::string name, unit;
  double value = 0, error = 0;  // in units of the model; infinite error: not resolved
};

struct ScatterFit {
  std::string model;                     // abg, harvey, k-correlation
  std::string why;                       // not empty: no fit, for this reason
  std::vector<FitParameter> parameters;  // three of the model, and the floor
  double chi2 = 0;                       // of residuals over their errors, upper limits included
  std::size_t freedom = 0;               // points that are no limits, less the parameters
  std::size_t outliers = 0;              // beyond 2.5 standard errors
  double rms = 0;                        // of log10(measured/fitted), points that are no limits
  bool scaled = false;                   // errors of the parameters are multiplied by sqrt(chi2/freedom)
  double tis = 0;                        // at normal incidence
  std::vector<double> fitted;            // BSDF at each point, 1/sr
  std::string yaml;                      // the model for a scene

  // BSDF in 1/sr at these cosines of incidence and of scatter.
  double at(double offset, double cos_i, double cos_s) const;
  std::vector<double> raw;  // ln of height, ln of width, exponent; ln of the floor
};

// Relative error of a point without a stated error.
constexpr double assumed_scatter_error = 0.1;

std::vector<ScatterFit> fit_scatter(ScatterFile const&, std::string const& source);

// The total of one incidence, as shares of the incident power: BSDF cos over the hemisphere, with the BSDF of this
// incidence as a function of |alpha - alpha_0| alone.
struct IncidenceAudit {
  double theta_i = 0;  // rad
  std::size_t points = 0, limits = 0;
  double nearest = 0, farthest = 0;  // offsets
  double tis = 0;
  double sampling = 0;                // change of the total without every second point
  double inside = 0, outside = 0;     // parts of `tis` nearer and farther than any point: extrapolated
  double stated = -1, integral = -1;  // as the file states, and the integral of its table; below 0: none
};

struct ScatterAudit {
  std::vector<IncidenceAudit> incidences;
  std::size_t points = 0, limits = 0, duplicates = 0, turns = 0;  // turns: reversals of the angle of scatter
  // The same pair of directions measured both ways: ratio of the two values as |ln|.
  std::size_t pairs = 0;
  double worst_reciprocity = 0, rms_reciprocity = 0;
  double spread = 1;  // largest ratio of points of one incidence at the same offset
};
ScatterAudit audit_scatter(ScatterFile const&, std::string_view beyond);

}  // namespace straytrace::world
