// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear least squares by the method of Levenberg and Marquardt (MINPACK's, in Eigen).
#pragma once

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include <functional>
#include <utility>

#include "base/namespaces.hpp"

namespace straytrace {

// Residuals as a function of parameters. Without `jacobian`, derivatives are central differences with steps of 1.5e-8
// of each parameter.
struct LeastSquaresProblem {
  Eigen::Index parameters, residuals;
  std::function<void(Eigen::VectorXd const& at, Eigen::VectorXd& out)> evaluate;
  std::function<void(Eigen::VectorXd const& at, Eigen::MatrixXd& out)> jacobian = {};
};

struct LeastSquaresMinimum {
  Eigen::VectorXd at;
  double cost = 0;  // sum of the squares
};

// A problem as Eigen takes it.
struct LeastSquaresFunctor {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  LeastSquaresProblem const& problem;

  int inputs() const { return int(problem.parameters); }
  int values() const { return int(problem.residuals); }
  int operator()(Eigen::VectorXd const& at, Eigen::VectorXd& out) const {
    problem.evaluate(at, out);
    return 0;
  }
  // Returns the number of evaluations.
  int df(Eigen::VectorXd const& at, Eigen::MatrixXd& out) const {
    if (!problem.jacobian) return Eigen::NumericalDiff<LeastSquaresFunctor, Eigen::Central>(*this).df(at, out);
    problem.jacobian(at, out);
    return 0;
  }
};

// The local minimum near `start`, to `tolerance` of the cost and of the parameters or after `evaluations` of the
// residuals.
inline LeastSquaresMinimum minimise(LeastSquaresProblem const& problem, Eigen::VectorXd start, int evaluations = 400,
                                    double tolerance = 1.4901161193847656e-8) {
  LeastSquaresFunctor functor{problem};
  Eigen::LevenbergMarquardt<LeastSquaresFunctor> solver(functor);
  solver.parameters.maxfev = evaluations;
  solver.parameters.ftol = solver.parameters.xtol = tolerance;
  solver.minimize(start);
  return {std::move(start), solver.fvec.squaredNorm()};
}

// Derivatives of the residuals: a row for each residual, a column for each parameter.
inline Eigen::MatrixXd derivatives(LeastSquaresProblem const& problem, Eigen::VectorXd const& at) {
  Eigen::MatrixXd out(problem.residuals, problem.parameters);
  LeastSquaresFunctor{problem}.df(at, out);
  return out;
}

}  // namespace straytrace
