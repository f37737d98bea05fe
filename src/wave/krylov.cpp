// SPDX-License-Identifier: BSD-3-Clause
#include "wave/krylov.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace straytrace::wave {

SpectrumDisc::SpectrumDisc(Grid const& grid, double largest_frequency) {
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      if (std::hypot(grid.frequency(row), grid.frequency(column)) < largest_frequency)
        at_.push_back(std::size_t(row) * std::size_t(grid.points) + std::size_t(column));
}

Eigen::VectorXcd SpectrumDisc::pack(Field const& spectrum) const {
  Eigen::VectorXcd packed(Eigen::Index(at_.size()));
  for (std::size_t i = 0; i < at_.size(); ++i) packed[Eigen::Index(i)] = spectrum.values[at_[i]];
  return packed;
}

void SpectrumDisc::unpack(Eigen::VectorXcd const& packed, Field& spectrum) const {
  std::ranges::fill(spectrum.values, Complex{});
  for (std::size_t i = 0; i < at_.size(); ++i) spectrum.values[at_[i]] = packed[Eigen::Index(i)];
}

Krylov::Krylov(Eigen::VectorXcd const& start) { vectors_.push_back(start.normalized()); }

bool Krylov::extend(Eigen::VectorXcd image) {
  auto const m = Eigen::Index(vectors_.size());
  matrix_.conservativeResizeLike(Eigen::MatrixXcd::Zero(m + 1, m));
  for (int pass = 0; pass < 2; ++pass)  // the second removes the rounding of the first
    for (Eigen::Index i = 0; i < m; ++i) {
      Complex const share = vectors_[std::size_t(i)].dot(image);
      matrix_(i, m - 1) += share;
      image -= share * vectors_[std::size_t(i)];
    }
  double const rest = image.norm();
  matrix_(m, m - 1) = rest;
  vectors_.push_back(rest > 0 ? Eigen::VectorXcd(image / rest) : image);
  return rest > 1e-14;
}

std::vector<RitzPair> Krylov::ritz() const {
  Eigen::Index const m = matrix_.cols();
  Eigen::ComplexEigenSolver<Eigen::MatrixXcd> const solved(matrix_.topRows(m));
  std::vector<RitzPair> pairs;
  for (Eigen::Index i = 0; i < m; ++i) {
    Eigen::VectorXcd const y = solved.eigenvectors().col(i).normalized();
    pairs.push_back({solved.eigenvalues()[i], std::abs(matrix_(m, m - 1) * y[m - 1]), std::abs(y[0]), y});
  }
  std::ranges::stable_sort(pairs, std::ranges::greater{}, &RitzPair::overlap);
  return pairs;
}

Eigen::VectorXcd Krylov::vector(RitzPair const& pair) const {
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(vectors_.front().size());
  for (Eigen::Index i = 0; i < pair.coordinates.size(); ++i) sum += pair.coordinates[i] * vectors_[std::size_t(i)];
  return sum;
}

}  // namespace straytrace::wave
