// SPDX-License-Identifier: BSD-3-Clause
// A measured coupling over a predicted one.
#pragma once

#include <string>
#include <vector>

#include "analysis/coupling/coupling.hpp"

namespace straytrace::analysis {

struct OverlayPoint {
  CouplingPoint measured;  // factor and error in the unit of the prediction
  double predicted = 0, predicted_sigma = 0;
  double ratio = 0;         // measured over predicted; of a limit: limit over predicted
  double error = 0;         // standard error of ln(ratio); 0 where none is known
  double significance = 0;  // of ln(ratio), standard deviations; of a limit: how far the prediction lies above it, or 0
  std::size_t bin = 0;      // of the prediction
};
struct Overlay {
  std::string unit;
  std::vector<OverlayPoint> points;                       // measured and limits within the band of the prediction
  double mean_ratio = 0, mean_sigma = 0, chi_square = 0;  // of ln(ratio), weighted; of the measured points against it
  std::size_t measured = 0,
              above_limit = 0;  // limits that the prediction, no upper bound, exceeds by 3 standard deviations
};

// The coupling predicted in bins: value and one standard error; zero where nothing couples.
struct PredictedCurve {
  std::vector<double> const &edges, &factor, &sigma;  // Hz; of each bin
  std::string unit;
  std::vector<bool> at_most = {};  // of each bin: upper bounds make a part of its factor; empty: of none
};
// Throws InputError for another dimension or a coupling that is fringe wrapped all over the band.
Overlay overlay_of(CouplingFunction const&, PredictedCurve const&);
// The most significant point in each bin of the prediction, a measured one before a limit; null: none.
std::vector<OverlayPoint const*> points_by_bin(Overlay const&, std::size_t bins);

}  // namespace straytrace::analysis
