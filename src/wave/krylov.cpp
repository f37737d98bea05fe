// SPDX-License-Identifier: BSD-3-Clause
#include "wave/krylov.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "base/process/threads.hpp"

namespace straytrace::wave {
namespace {

constexpr double rounding = 1e-14;    // of an image with nothing new in it
constexpr double least_start = 1e-6;  // of a start beside the others
constexpr Eigen::Index slice = 1024;  // elements of a vector that stay in the cache

}  // namespace

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

Krylov::Krylov(std::vector<Eigen::VectorXcd> const& starts, int threads) : threads_(unsigned(std::max(0, threads))) {
  for (Eigen::VectorXcd const& start : starts) {
    Eigen::VectorXcd rest = start.normalized();
    orthogonalise(rest);
    if (rest.norm() > least_start) vectors_.push_back(rest.normalized());
  }
  starts_ = int(vectors_.size());
}

// Classical Gram-Schmidt, twice: the second removes the rounding of the first. Slice by slice, so that the vectors are
// read from memory three times in all.
Eigen::VectorXcd Krylov::orthogonalise(Eigen::VectorXcd& image) const {
  auto const count = Eigen::Index(vectors_.size());
  Eigen::MatrixXcd parts(count, (image.size() + slice - 1) / slice);  // of the shares, by slice
  auto const sweep = [&](Eigen::VectorXcd const* subtracted, bool measured) {
    in_parallel(std::size_t(parts.cols()), threads_, [&](std::size_t s) {
      Eigen::Index const first = Eigen::Index(s) * slice, size = std::min(slice, image.size() - first);
      auto here = image.segment(first, size);
      for (Eigen::Index i = 0; subtracted && i < count; ++i)
        here -= (*subtracted)[i] * vectors_[std::size_t(i)].segment(first, size);
      for (Eigen::Index i = 0; measured && i < count; ++i)
        parts(i, Eigen::Index(s)) = vectors_[std::size_t(i)].segment(first, size).dot(here);
    });
  };
  auto const summed = [&] {
    Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(count);
    for (Eigen::Index s = 0; s < parts.cols(); ++s) sum += parts.col(s);
    return sum;
  };
  sweep(nullptr, true);
  Eigen::VectorXcd const shares = summed();
  sweep(&shares, true);
  Eigen::VectorXcd const rounded = summed();
  sweep(&rounded, false);
  return shares + rounded;
}

bool Krylov::extend(Eigen::VectorXcd image) {
  Eigen::Index const m = matrix_.cols();
  Eigen::VectorXcd const shares = orthogonalise(image);
  double const rest = image.norm();
  if (rest > rounding) vectors_.emplace_back(image / rest);
  matrix_.conservativeResizeLike(Eigen::MatrixXcd::Zero(Eigen::Index(vectors_.size()), m + 1));
  matrix_.col(m).head(shares.size()) = shares;
  if (rest > rounding) matrix_(shares.size(), m) = rest;
  return m + 1 < Eigen::Index(vectors_.size());
}

std::vector<RitzPair> Krylov::ritz() const {
  Eigen::Index const m = matrix_.cols(), in_starts = std::min(Eigen::Index(starts_), m);
  Eigen::ComplexEigenSolver<Eigen::MatrixXcd> const solved(matrix_.topRows(m));
  std::vector<RitzPair> pairs;
  for (Eigen::Index i = 0; i < m; ++i) {
    Eigen::VectorXcd const y = solved.eigenvectors().col(i).normalized();
    double const residual = (matrix_.bottomRows(matrix_.rows() - m) * y).norm();
    pairs.push_back({solved.eigenvalues()[i], residual, y.head(in_starts).norm(), y});
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
