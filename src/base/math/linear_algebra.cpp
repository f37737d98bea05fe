// SPDX-License-Identifier: BSD-3-Clause
#include "base/math/linear_algebra.hpp"

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include <utility>

namespace straytrace {

using Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::VectorXcd, Eigen::VectorXd;

SymmetricModes symmetric_modes(MatrixXd const& symmetric) {
  Eigen::SelfAdjointEigenSolver<MatrixXd> const solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd symmetric_eigenvalues(MatrixXd const& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

ComplexModes complex_modes(MatrixXcd const& matrix) {
  Eigen::ComplexEigenSolver<MatrixXcd> const solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXcd complex_eigenvalues(MatrixXcd const& matrix) {
  return Eigen::ComplexEigenSolver<MatrixXcd>(matrix, false).eigenvalues();
}

SchurForm schur_form(MatrixXcd const& matrix) {
  Eigen::ComplexSchur<MatrixXcd> const schur(matrix);
  return {schur.matrixT(), schur.matrixU()};
}

VectorXcd solve(MatrixXcd const& a, VectorXcd const& b) { return a.partialPivLu().solve(b); }

VectorXd solve_symmetric(MatrixXd const& a, VectorXd const& b) { return a.ldlt().solve(b); }

MatrixXcd inverse(MatrixXcd const& matrix) { return matrix.inverse(); }

MatrixXd inverse(MatrixXd const& matrix) { return matrix.inverse(); }

std::optional<VectorXd> solve_regular(MatrixXd const& a, VectorXd const& b, double threshold) {
  Eigen::FullPivLU<MatrixXd> solver(a);
  solver.setThreshold(threshold);
  if (!solver.isInvertible()) return {};
  return VectorXd(solver.solve(b));
}

std::optional<MatrixXd> inverse_regular(MatrixXd const& matrix) {
  Eigen::FullPivLU<MatrixXd> const solver(matrix);
  if (!solver.isInvertible()) return {};
  return MatrixXd(solver.inverse());
}

namespace {

template <class Matrix>
Matrix thin_q(Matrix const& columns) {
  return Eigen::HouseholderQR<Matrix>(columns).householderQ() * Matrix::Identity(columns.rows(), columns.cols());
}

}  // namespace

MatrixXd orthonormal_columns(MatrixXd const& columns) { return thin_q(columns); }

MatrixXcd orthonormal_columns(MatrixXcd const& columns) { return thin_q(columns); }

MatrixXd linear_least_squares(MatrixXd const& a, MatrixXd const& b) { return a.colPivHouseholderQr().solve(b); }

MatrixXd least_norm_solution(MatrixXd const& a, MatrixXd const& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver;
  solver.setThreshold(threshold);
  solver.compute(a);
  return solver.solve(b);
}

namespace {

// A problem as Eigen takes it.
struct LeastSquaresFunctor {
  using Scalar = double;
  using InputType = VectorXd;
  using ValueType = VectorXd;
  using JacobianType = MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  LeastSquaresProblem const& problem;

  int inputs() const { return int(problem.parameters); }
  int values() const { return int(problem.residuals); }
  int operator()(VectorXd const& at, VectorXd& out) const {
    problem.evaluate(at, out);
    return 0;
  }
  // Returns the number of evaluations.
  int df(VectorXd const& at, MatrixXd& out) const {
    if (!problem.jacobian) return Eigen::NumericalDiff<LeastSquaresFunctor, Eigen::Central>(*this).df(at, out);
    problem.jacobian(at, out);
    return 0;
  }
};

}  // namespace

LeastSquaresMinimum minimise(LeastSquaresProblem const& problem, VectorXd start, int evaluations, double tolerance) {
  LeastSquaresFunctor functor{problem};
  Eigen::LevenbergMarquardt<LeastSquaresFunctor> solver(functor);
  solver.parameters.maxfev = evaluations;
  solver.parameters.ftol = solver.parameters.xtol = tolerance;
  solver.minimize(start);
  return {std::move(start), solver.fvec.squaredNorm()};
}

MatrixXd derivatives(LeastSquaresProblem const& problem, VectorXd const& at) {
  MatrixXd out(problem.residuals, problem.parameters);
  LeastSquaresFunctor{problem}.df(at, out);
  return out;
}

}  // namespace straytrace
