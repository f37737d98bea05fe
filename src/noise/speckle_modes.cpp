// SPDX-License-Identifier: BSD-3-Clause
#include "noise/speckle_modes.hpp"

#include <algorithm>

namespace straytrace {
namespace {

using Eigen::MatrixXd;

// Of Re and Im of the vector.
MatrixXd real_covariance(SpeckleMoments const& moments) {
  auto const& [gamma, relation] = moments;
  Eigen::Index const n = gamma.rows();
  MatrixXd out(2 * n, 2 * n);
  out.topLeftCorner(n, n) = 0.5 * (gamma + relation).real();
  out.bottomRightCorner(n, n) = 0.5 * (gamma - relation).real();
  out.topRightCorner(n, n) = 0.5 * (relation - gamma).imag();
  out.bottomLeftCorner(n, n) = out.topRightCorner(n, n).transpose();
  return out;
}

}  // namespace

std::vector<SpeckleMode> modes_of(std::vector<SpeckleMoments> const& blocks, bool directions) {
  std::vector<SpeckleMode> modes;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Eigen::SelfAdjointEigenSolver<MatrixXd> const own(real_covariance(blocks[b]),
                                                      directions ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
    for (Eigen::Index m = own.eigenvalues().size(); m-- > 0;) {
      modes.push_back({std::max(0.0, own.eigenvalues()(m)), b, {}});
      if (directions) modes.back().direction = own.eigenvectors().col(m);
    }
  }
  std::stable_sort(modes.begin(), modes.end(),
                   [](SpeckleMode const& a, SpeckleMode const& b) { return a.weight > b.weight; });
  return modes;
}

}  // namespace straytrace
