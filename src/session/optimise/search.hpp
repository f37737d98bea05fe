// SPDX-License-Identifier: BSD-3-Clause
// The least of an objective under limits that are measured at a cost: trust region and steps of counts
// (docs/theory/optimisation.md).
#pragma once

#include <Eigen/Dense>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/math/constants.hpp"
#include "base/namespaces.hpp"
#include "results/results.hpp"

namespace straytrace::session {

// Quadratic models about a point, and the least of one of them inside a box by NLopt (docs/theory/optimisation.md).

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

struct SearchRange {
  double low = 0, high = 1;
  bool whole = false;  // only whole numbers
};

// What was found at a point.
struct Candidate {
  std::vector<double> at;
  double objective = not_a_number;
  std::vector<double>
      excess;              // of every limit, in logarithms or relative: at most 0 where it is met; NaN: not measured
  double sigma = 0;        // standard error of the largest, Monte Carlo
  std::size_t number = 0;  // of the evaluation; a caller keeps more under it
  std::vector<double> deviations{};            // of the logarithm of what decides, by replica; empty: without error
  std::vector<double> objective_deviations{};  // by replica; empty: without error
  std::vector<std::vector<double>> excess_deviations{};  // of every limit, by replica; empty: without error
  int level = 0;                                         // of the accuracy

  double worst() const;  // largest excess; infinite where one was not measured
  bool met() const { return worst() <= 0; }
};
// The better one: limits met, then the lower objective, then more room below the limits.
bool better(Candidate const&, Candidate const&);

struct SearchProblem {
  std::vector<SearchRange> ranges;
  std::vector<double> start;
  std::function<std::optional<Candidate>(std::vector<double> const&, int level)> evaluate;  // none: stopped
  int levels = 1;  // of the accuracy, from 0 on: raised where the error hides the predicted gain (eq. O.10)
  // The objective where no measurement is needed for it, otherwise empty: its steps are then searched.
  std::function<double(std::vector<double> const&)> price;
  double tolerance = 0.01;  // of the ranges
  std::size_t most = 60;    // evaluations
};

struct SearchResult {
  std::vector<Candidate> all;  // in the order of evaluation, each point once
  std::string ended;           // why: "the region is below the tolerance"
  bool stopped = false;
  // Of the limits at the best candidate: by how much the objective falls where the excess of one may be 1 higher (eq.
  // O.9), with the Monte-Carlo error of the slopes. 0: it does not bind. NaN: not known, as where the objective has
  // steps. Empty: none meets the limits.
  std::vector<WithError> multipliers;
  Candidate const* best() const;  // none where no limit is met
  Candidate const* closest() const;
};

SearchResult search(SearchProblem const&);

}  // namespace straytrace::session
