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
  double residual = 0, overlap = 0;  // eq. W.9; share of amplitude of the start
  Eigen::VectorXcd coordinates;      // of the eigenvector, in the basis of Arnoldi
};

// Arnoldi's orthonormal vectors of start, G start, G^2 start, ... and the matrix of G between them.
class Krylov {
 public:
  explicit Krylov(Eigen::VectorXcd const& start);

  int steps() const { return int(vectors_.size()) - 1; }
  Eigen::VectorXcd const& last() const { return vectors_.back(); }
  // `image` is G times `last()`. False when nothing new is in it.
  bool extend(Eigen::VectorXcd image);
  std::vector<RitzPair> ritz() const;  // by overlap with the start, largest first
  Eigen::VectorXcd vector(RitzPair const&) const;

 private:
  std::vector<Eigen::VectorXcd> vectors_;
  Eigen::MatrixXcd matrix_;  // Hessenberg, one row more than columns
};

}  // namespace straytrace::wave
