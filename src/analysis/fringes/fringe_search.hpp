// SPDX-License-Identifier: BSD-3-Clause
// Parts of fit_fringes: the place of all paths in their ranges, the scan of one path, the refinement of all.
#pragma once

#include "analysis/fringes/fringe_fit.hpp"

namespace straytrace::analysis {

// Samples of the target where every witness is known: with delays either way, and, where it is sampled more slowly,
// with the 16 samples that interpolation reaches for. Empty where there are none.
struct SampleSpan {
  std::size_t from = 0, to = 0;
};
SampleSpan covered(FringeRecords const&, double longest_delay);

struct FringePlace {
  std::vector<FringeShape> shapes;  // of the paths
  double ratio = 0;
};

// A stretch with the responses of the paths and a noise level.
struct FringeProblem {
  FringeStretch const& stretch;
  FringeFitSettings const& settings;
  std::vector<FringeStretch::Response> responses;  // of the paths
  std::vector<double> psd;                         // on stretch.hz()

  Eigen::VectorXd features(FringeLines const&) const;  // by settings.method
  Eigen::MatrixXd columns(FringePlace const&) const;   // features x 2 paths
  FringeLines model(FringePlace const&, Eigen::VectorXd const& linear) const;
};

struct LinearFit {
  Eigen::VectorXd linear;  // sqrt(f_r) (cos phi, sin phi) of each path
  double chi2 = 0;
};
LinearFit linear_fit(Eigen::MatrixXd const& columns, Eigen::VectorXd const& target);

// Steps so fine that no maximum of the likelihood falls between them (docs/theory/fit.md).
struct SearchGrid {
  std::vector<double> multiplicity, delay, drift, ratio;
  double transforms() const;
};
SearchGrid search_grid(FringeStretch const&, FringeFitSettings const&, std::size_t path, double ratio);

// The best places for path `path`, best first, at most `most`, with the others fixed.
std::vector<FringePlace> scan(FringeProblem const&, FringePlace const& others, std::size_t path, std::size_t most);
// Side lengths of the ranges of a path around a place, for ln_chance_of.
std::vector<double> range_lengths(FringeProblem const&, FringePlace const&, std::size_t path);

struct RefinedFit {
  FringePlace place;
  LinearFit fit;
  Eigen::MatrixXd covariance;  // of linear (2 for each path), then the free ones in the order of free_parameters
};
struct FreeParameter {
  enum class Kind : std::uint8_t { multiplicity, delay, drift, ratio } kind;
  std::size_t path = 0;
};
std::vector<FreeParameter> free_parameters(FringeFitSettings const&, std::size_t paths);
double& value_of(FringePlace&, FreeParameter const&);
SearchRange const& range_of(FringeFitSettings const&, FreeParameter const&);
// Of the model's features with respect to linear and the free ones, in the order of the covariance.
Eigen::MatrixXd jacobian(FringeProblem const&, FringePlace const&, Eigen::VectorXd const& linear);
// Least squares in all free parameters, within their ranges.
RefinedFit refine(FringeProblem const&, FringePlace const& from);

// Searches path after path and moves all together; takes the noise level of the problem from the residuals.
RefinedFit fit_all(FringeProblem&);
// Paths, ratio, names and correlations: amplitude and phase instead of cosine and sine, with their errors.
void report_parameters(FringeFit&, FringeProblem const&, RefinedFit const&);

// The fit of one stretch, its covariance included, against another with the same noise level.
OutOfSample out_of_sample(FringeProblem const& fitted, RefinedFit const&, FringeStretch const& rest);
FitOutcome verdict_of(FringeFit const&, double false_alarm);

}  // namespace straytrace::analysis
