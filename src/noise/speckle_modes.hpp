// SPDX-License-Identifier: BSD-3-Clause
// What Gaussian amplitudes of many inputs do together, in independent parts (docs/theory/spectra.md).
#pragma once

#include <Eigen/Dense>

#include <vector>

namespace straytrace {

// Second moments of the complex amplitudes of some inputs: E H H^+ and E H H^T. Routes tie inputs together; inputs of
// different blocks have no moments in common, so that the work grows with the cube of the largest block alone.
struct SpeckleMoments {
  Eigen::MatrixXcd gamma, relation;
};

// An independent part of the vector of one block: its variance, and its unit direction, real parts before imaginary
// parts.
struct SpeckleMode {
  double weight;
  std::size_t block;
  Eigen::VectorXd direction;
};

// Of all blocks, the largest first. Without directions, which take most of the time, those of the modes are empty.
std::vector<SpeckleMode> modes_of(std::vector<SpeckleMoments> const& blocks, bool directions);

}  // namespace straytrace
