// SPDX-License-Identifier: BSD-3-Clause
// A measured coupling over a predicted one.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "analysis/coupling/coupling.hpp"
#include "noise/project/predicted_coupling.hpp"
#include "results/curves/curve_file.hpp"

namespace straytrace::cli {

struct OverlayPoint {
  CouplingPoint measured;  // factor and error in the unit of the prediction
  double predicted = 0, predicted_sigma = 0;
  double ratio = 0;         // measured over predicted; of a limit: limit over predicted
  double error = 0;         // standard error of ln(ratio); 0 where none is known
  double significance = 0;  // of ln(ratio), standard deviations; of a limit: how far the prediction lies above it, or 0
};
struct Overlay {
  std::string unit;
  std::vector<OverlayPoint> points;                       // measured and limits within the band of the prediction
  double mean_ratio = 0, mean_sigma = 0, chi_square = 0;  // of ln(ratio), weighted; of the measured points against it
  std::size_t measured = 0, above_limit = 0;              // limits that the prediction exceeds by 3 standard deviations
};

CouplingFunction read_coupling(std::string const& file, std::string const& unit, std::string const& witness_unit);
// Throws InputError for another dimension or a coupling that is fringe wrapped all over the band.
Overlay overlay_of(CouplingFunction const&, PredictedCoupling const&, std::string const& unit);
std::string overlay_text(Overlay const&, std::size_t show);
nlohmann::json overlay_json(Overlay const&);
// Measured points and limits on the axis of the sheet: each in its bin, the most significant one.
void add_overlay(CurveSheet&, Overlay const&);

}  // namespace straytrace::cli
