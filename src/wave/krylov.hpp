// SPDX-License-Identifier: BSD-3-Clause
// Eigenvalues of the round trip of a field, from the field after each of a few round trips (docs/theory/wave.md, eq.
// W.9).
#pragma once

#include <Eigen/Core>

#include <vector>

#include "wave/field.hpp"

namespace straytrace::wave {

// The elements of a spectrum below a frequency [1/m], as a vector.
class SpectrumDisc {
 public:
  SpectrumDisc() = default;
  SpectrumDisc(Grid const&, double largest_frequency);
  Eigen::VectorXcd pack(Field const& spectrum) const;
  void unpack(Eigen::VectorXcd const&, Field& spectrum) const;

 private:
  std::vector<std::size_t> at_;
};

// An eigenvalue with its eigenvector.
struct RitzPair {
  Complex value;
  double residual = 0, overlap = 0;  // eq. W.9; share of amplitude in the starts
  Eigen::VectorXcd coordinates;      // of the eigenvector, in the basis of Arnoldi
};

// Arnoldi's orthonormal vectors of one or several starts s, G s, G^2 s, ... and the matrix of G between them. With
// several starts, eigenvalues of one size keep as many eigenvectors apart.
class Krylov {
 public:
  explicit Krylov(Eigen::VectorXcd const& start, int threads = 1)
      : Krylov(std::vector<Eigen::VectorXcd>{start}, threads) {}
  explicit Krylov(std::vector<Eigen::VectorXcd> const& starts, int threads = 1);

  int steps() const { return int(matrix_.cols()); }
  int starts() const { return starts_; }  // that are independent
  std::vector<Eigen::VectorXcd> const& vectors() const { return vectors_; }
  Eigen::VectorXcd const& next() const { return vectors_[std::size_t(steps())]; }  // whose image `extend` takes
  // `image` is G times `next()`. False when nothing new is left to map.
  bool extend(Eigen::VectorXcd image);
  Eigen::MatrixXcd const& matrix() const { return matrix_; }
  std::vector<RitzPair> ritz() const;  // by overlap with the starts, largest first
  Eigen::VectorXcd vector(RitzPair const&) const;

 private:
  // Takes the shares of the vectors out of one; the shares. The same bits for any number of threads.
  Eigen::VectorXcd orthogonalise(Eigen::VectorXcd&) const;

  unsigned threads_;
  std::vector<Eigen::VectorXcd> vectors_;
  int starts_ = 0;
  Eigen::MatrixXcd matrix_;  // Hessenberg with as many subdiagonals as starts; rows: vectors, columns: steps
};

}  // namespace straytrace::wave
