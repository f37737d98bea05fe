// SPDX-License-Identifier: BSD-3-Clause
// Decompositions (base/math/linear_algebra.hpp) against their definitions, on matrices with known answers.
#include "base/math/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace straytrace::testing::linear_algebra {
namespace {

using Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::VectorXcd, Eigen::VectorXd;
using Complex = std::complex<double>;

MatrixXd tall() {
  MatrixXd a(4, 3);
  a << 1, 2, 0, 3, -1, 2, 0, 4, 1, 2, 2, -3;
  return a;
}

// Second differences with fixed ends: 2 - 2 cos(k pi/(n + 1)).
TEST(LinearAlgebra, EigenvaluesOfSecondDifferences) {
  constexpr int n = 6;
  MatrixXd matrix = 2 * MatrixXd::Identity(n, n);
  for (int i = 1; i < n; ++i) matrix(i, i - 1) = matrix(i - 1, i) = -1;
  SymmetricModes const modes = symmetric_modes(matrix);
  for (int k = 0; k < n; ++k) EXPECT_NEAR(modes.values[k], 2 - 2 * std::cos((k + 1) * M_PI / (n + 1)), 1e-14);
  EXPECT_LT((matrix * modes.vectors - modes.vectors * modes.values.asDiagonal()).norm(), 1e-13);
  EXPECT_LT((modes.vectors.transpose() * modes.vectors - MatrixXd::Identity(n, n)).norm(), 1e-13);
  EXPECT_LT((symmetric_eigenvalues(matrix) - modes.values).norm(), 1e-13);
}

// A cyclic shift has the roots of one as eigenvalues; it is not Hermitian.
TEST(LinearAlgebra, EigenvaluesOfACyclicShift) {
  constexpr int n = 5;
  MatrixXcd shift = MatrixXcd::Zero(n, n);
  for (int i = 0; i < n; ++i) shift((i + 1) % n, i) = 1;
  ComplexModes const modes = complex_modes(shift);
  EXPECT_LT((shift * modes.vectors - modes.vectors * modes.values.asDiagonal()).norm(), 1e-13);
  VectorXcd const values = complex_eigenvalues(shift);
  for (int i = 0; i < n; ++i) EXPECT_LT(std::abs(std::pow(values[i], n) - 1.0), 1e-13);
  EXPECT_LT(std::abs(values.sum()), 1e-13) << "each root once";
  SchurForm const schur = schur_form(shift);
  EXPECT_LT((schur.basis * schur.triangle * schur.basis.adjoint() - shift).norm(), 1e-13);
  EXPECT_LT(schur.triangle.triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm(), 1e-13);
}

TEST(LinearAlgebra, SquareSystems) {
  MatrixXcd a(2, 2);
  a << Complex(0, 1), 2, 3, Complex(1, -1);
  VectorXcd b(2);
  b << 1, Complex(0, 2);
  EXPECT_LT((a * solve(a, b) - b).norm(), 1e-14);
  EXPECT_LT((a * inverse(a) - MatrixXcd::Identity(2, 2)).norm(), 1e-14);
  MatrixXd const square = tall().transpose() * tall();
  VectorXd const right = VectorXd::LinSpaced(3, 1, 2);
  EXPECT_LT((square * solve_symmetric(square, right) - right).norm(), 1e-12);
  EXPECT_LT((square * solve_regular(square, right, 1e-10).value() - right).norm(), 1e-12);
  EXPECT_LT((square * inverse_regular(square).value() - MatrixXd::Identity(3, 3)).norm(), 1e-12);
  EXPECT_LT((square * inverse(square) - MatrixXd::Identity(3, 3)).norm(), 1e-12);
  MatrixXd singular = square;
  singular.row(2) = singular.row(0) + singular.row(1);
  EXPECT_FALSE(inverse_regular(singular));
  EXPECT_FALSE(solve_regular(singular, right, 1e-10));
  EXPECT_FALSE(solve_regular(square, right, 0.9)) << "the threshold is of the largest pivot";
}

TEST(LinearAlgebra, OrthonormalColumnsSpanTheSame) {
  MatrixXd const q = orthonormal_columns(tall());
  EXPECT_LT((q.transpose() * q - MatrixXd::Identity(3, 3)).norm(), 1e-14);
  EXPECT_LT((q * (q.transpose() * tall()) - tall()).norm(), 1e-14);
  MatrixXcd const turned = Complex(0.6, 0.8) * tall(), p = orthonormal_columns(turned);
  EXPECT_LT((p.adjoint() * p - MatrixXcd::Identity(3, 3)).norm(), 1e-14);
  EXPECT_LT((p * (p.adjoint() * turned) - turned).norm(), 1e-14);
}

// The residual of the least squares is orthogonal to all columns; where columns are alike, the shortest solution gives
// them equal parts.
TEST(LinearAlgebra, LeastSquares) {
  VectorXd b(4);
  b << 1, 0, 2, -1;
  MatrixXd const x = linear_least_squares(tall(), b);
  EXPECT_LT((tall().transpose() * (tall() * x - b)).norm(), 1e-13);
  EXPECT_GT((tall() * x - b).norm(), 0.1);
  EXPECT_LT((least_norm_solution(tall(), b, 1e-9) - x).norm(), 1e-13);
  MatrixXd twice(4, 2);
  twice << tall().col(0), tall().col(0);
  MatrixXd const part = least_norm_solution(twice, 3 * tall().col(0), 1e-9);
  EXPECT_NEAR(part(0, 0), 1.5, 1e-13);
  EXPECT_NEAR(part(1, 0), 1.5, 1e-13);
}

// Rosenbrock's valley, with and without derivatives.
TEST(LinearAlgebra, NonlinearLeastSquares) {
  LeastSquaresProblem problem{2, 2, [](VectorXd const& at, VectorXd& out) {
                                out[0] = 10 * (at[1] - at[0] * at[0]);
                                out[1] = 1 - at[0];
                              }};
  VectorXd const start = Eigen::Vector2d(-1.2, 1), least = minimise(problem, start).at;
  EXPECT_LT((least - Eigen::Vector2d(1, 1)).norm(), 1e-6);
  MatrixXd slope(2, 2);
  slope << 24, 10, -1, 0;
  EXPECT_LT((derivatives(problem, start) - slope).norm(), 1e-5);
  problem.jacobian = [](VectorXd const& at, MatrixXd& out) { out << -20 * at[0], 10, -1, 0; };
  LeastSquaresMinimum const exact = minimise(problem, start);
  EXPECT_LT((exact.at - Eigen::Vector2d(1, 1)).norm(), 1e-6);
  EXPECT_LT(exact.cost, 1e-12);
}

}  // namespace
}  // namespace straytrace::testing::linear_algebra
