// SPDX-License-Identifier: BSD-3-Clause
// Errors of a shelf edge by repetition (docs/theory/fit.md, shelf edge).
#pragma once

#include <vector>

#include "commission/shelf_shape.hpp"

namespace straytrace {

constexpr double factor_step = 0.005;  // of ln(factor) in a profile

// 2 ln L over ln(factor), best floor and response at each.
struct ShelfProfile {
  FactorGrid grid;
  std::vector<double> twice_log;
  double without = 0;  // shelf
  ShelfSpectrum::Best best;
  std::size_t top() const;
};

// Top of a parabola through the best place and those where the profile has fallen by about 2 to either side.
struct ProfileTop {
  double log_factor = 0, sigma = 0;  // as if the shelf were Gaussian noise
  bool at_end = false;               // of the grid
};
ProfileTop top_of(ShelfProfile const&);

ShelfProfile profile_on(ShelfStride const&, Eigen::Ref<Eigen::VectorXd const> const& psd, Eigen::MatrixXd const& shapes,
                        FactorGrid const&);

// A stride with the edge that was found in it.
struct FoundEdge {
  ShelfStride const* stride = nullptr;
  ProfileTop top;
  ShelfSpectrum::Best best;
};

// Offset and standard deviation of ln(factor), found less true, of each edge and of their weighted mean.
struct RepeatedEdges {
  std::vector<double> offset, sigma;
  double mean = 0, mean_offset = 0, mean_sigma = 0;
};
RepeatedEdges repeated(std::vector<FoundEdge> const&, double ratio, double wavelength);

}  // namespace straytrace
