// SPDX-License-Identifier: BSD-3-Clause
// Decompositions of dense matrices by Eigen, compiled once: each takes two to eight seconds in every file that uses it.
#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>

#include "base/namespaces.hpp"

namespace straytrace {

// Eigenvectors of a symmetric matrix are orthonormal columns; eigenvalues ascend.
struct SymmetricModes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricModes symmetric_modes(Eigen::MatrixXd const& symmetric);
Eigen::VectorXd symmetric_eigenvalues(Eigen::MatrixXd const& symmetric);

// Of any matrix, in no order; columns of norm 1 that need not be orthogonal.
struct ComplexModes {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
ComplexModes complex_modes(Eigen::MatrixXcd const&);
Eigen::VectorXcd complex_eigenvalues(Eigen::MatrixXcd const&);

// matrix = basis triangle basis*: `triangle` is upper triangular, `basis` unitary.
struct SchurForm {
  Eigen::MatrixXcd triangle, basis;
};
SchurForm schur_form(Eigen::MatrixXcd const&);

// Square systems. `solve_symmetric` takes semidefinite ones too.
Eigen::VectorXcd solve(Eigen::MatrixXcd const& a, Eigen::VectorXcd const& b);
Eigen::VectorXd solve_symmetric(Eigen::MatrixXd const& a, Eigen::VectorXd const& b);
Eigen::MatrixXcd inverse(Eigen::MatrixXcd const&);
Eigen::MatrixXd inverse(Eigen::MatrixXd const&);
// Empty where a pivot is at most `threshold` times the largest; without it, at most rounding.
std::optional<Eigen::VectorXd> solve_regular(Eigen::MatrixXd const& a, Eigen::VectorXd const& b, double threshold);
std::optional<Eigen::MatrixXd> inverse_regular(Eigen::MatrixXd const&);

// Orthonormal columns that span those of the matrix, which has at least as many rows.
Eigen::MatrixXd orthonormal_columns(Eigen::MatrixXd const&);
Eigen::MatrixXcd orthonormal_columns(Eigen::MatrixXcd const&);

// x with the least |a x - b|, a column for each of b; the second one has the least norm where pivots below `threshold`
// of the largest leave a choice.
Eigen::MatrixXd linear_least_squares(Eigen::MatrixXd const& a, Eigen::MatrixXd const& b);
Eigen::MatrixXd least_norm_solution(Eigen::MatrixXd const& a, Eigen::MatrixXd const& b, double threshold);

// Nonlinear least squares by the method of Levenberg and Marquardt (MINPACK's, in Eigen): residuals as a function of
// parameters. Without `jacobian`, derivatives are central differences with steps of 1.5e-8 of each parameter.
struct LeastSquaresProblem {
  Eigen::Index parameters, residuals;
  std::function<void(Eigen::VectorXd const& at, Eigen::VectorXd& out)> evaluate;
  std::function<void(Eigen::VectorXd const& at, Eigen::MatrixXd& out)> jacobian = {};
};
struct LeastSquaresMinimum {
  Eigen::VectorXd at;
  double cost = 0;  // sum of the squares
};
// The local minimum near `start`, to `tolerance` of the cost and of the parameters or after `evaluations` of the
// residuals.
LeastSquaresMinimum minimise(LeastSquaresProblem const&, Eigen::VectorXd start, int evaluations = 400,
                             double tolerance = 1.4901161193847656e-8);
// Derivatives of the residuals: a row for each residual, a column for each parameter.
Eigen::MatrixXd derivatives(LeastSquaresProblem const&, Eigen::VectorXd const& at);

}  // namespace straytrace
