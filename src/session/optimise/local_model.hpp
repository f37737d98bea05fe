// SPDX-License-Identifier: BSD-3-Clause
// Quadratic models about a point, and the least of one of them inside a box by NLopt (docs/theory/optimisation.md).
#pragma once

#include <Eigen/Dense>

#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::session {

// value + slope s + s curvature s / 2, s the step from the centre.
struct Quadratic {
  double value = 0;
  Eigen::VectorXd slope;
  Eigen::MatrixXd curvature;

  double at(Eigen::VectorXd const& step) const;
  Eigen::VectorXd gradient(Eigen::VectorXd const& step) const { return slope + curvature * step; }
};

// Least squares over values at these steps (eq. O.4); the nearer to the centre, in units of `radius`, the more weight.
// Non-finite values are left out. Of the models that fit equally well the one with the smallest coefficients.
Quadratic fitted(std::vector<Eigen::VectorXd> const& steps, std::vector<double> const& values, double radius);

// Minimises objective + penalty * slack, with every limit <= slack and slack >= 0 (eq. O.5).
struct Subproblem {
  Quadratic objective;
  std::vector<Quadratic> limits;
  Eigen::VectorXd low, high;  // of the step
  double penalty = 10;

  double slack(Eigen::VectorXd const& step) const;  // of the models: largest excess, at least 0
  double merit(Eigen::VectorXd const& step) const;  // of the models
  Eigen::VectorXd least() const;                    // SLSQP; COBYLA where that fails
};

}  // namespace straytrace::session
