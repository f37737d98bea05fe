// SPDX-License-Identifier: BSD-3-Clause
// Parameters of a cavity from the power measured on photodiodes, by least squares with the covariance of speckle
// (docs/theory/wave.md, eq. W.44).
#pragma once

#include <Eigen/Core>

#include <functional>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::wave {

// Of one parameter, in its own unit; the search starts in the middle.
struct FitRange {
  double low = 0, high = 0;
};

struct DiodeFitProblem {
  std::vector<FitRange> ranges;
  Eigen::VectorXd measured, error;                                       // W; one standard deviation of the measurement
  std::function<Eigen::VectorXd(Eigen::VectorXd const& at)> mean;        // W
  std::function<Eigen::MatrixXd(Eigen::VectorXd const& at)> covariance;  // of the speckle, W^2
};

struct DiodeFit {
  struct Parameter {
    double value = 0, sigma = 0;
    bool determined = true;  // by the data, to better than half its range
    bool at_end = false;     // of its range
  };
  std::vector<Parameter> parameters;
  // Combinations that the data do not determine, in half ranges: of unit length.
  std::vector<Eigen::VectorXd> undetermined;
  Eigen::MatrixXd correlation;  // 0 for parameters that are not determined
  Eigen::VectorXd mean, sigma;  // of the model, with speckle and measurement. W
  double chi2 = 0;
  int degrees = 0;
  // Speckle fluctuates more than a normal distribution: the chi^2 distribution of this many degrees, scaled to the mean
  // of `degrees`, has the variance of chi2.
  double effective_degrees = 0;
  double probability = 0;  // of a larger chi2
};
// Throws NumericalError where the covariance is not finite.
DiodeFit fit_diodes(DiodeFitProblem const&);

}  // namespace straytrace::wave
