// SPDX-License-Identifier: BSD-3-Clause
// Straight lines through a few points with known errors.
#pragma once

#include <cmath>
#include <span>

namespace straytrace {

struct WeightedMean {
  double value = 0, sigma = 0;  // standard error, larger by sqrt(chi^2/dof) where the values disagree
};
inline WeightedMean weighted_mean(std::span<double const> y, std::span<double const> sigma) {
  double weight = 0, sum = 0, chi = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    weight += 1 / (sigma[i] * sigma[i]);
    sum += y[i] / (sigma[i] * sigma[i]);
  }
  for (std::size_t i = 0; i < y.size(); ++i) chi += std::pow((y[i] - sum / weight) / sigma[i], 2);
  double const spread = y.size() > 1 ? chi / double(y.size() - 1) : 0;
  return {sum / weight, std::sqrt((spread > 1 ? spread : 1) / weight)};
}

struct WeightedLine {
  double offset = 0, slope = 0;              // at x = 0; dy/dx
  double slope_sigma = 0, offset_sigma = 0;  // from the errors stated
  double chi_square = 0;                     // dof: points less two
};
// Slope and errors are NaN or infinite when all x are equal.
inline WeightedLine weighted_line(std::span<double const> x, std::span<double const> y, std::span<double const> sigma) {
  double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double const w = 1 / (sigma[i] * sigma[i]);
    s += w;
    sx += w * x[i];
    sy += w * y[i];
    sxx += w * x[i] * x[i];
    sxy += w * x[i] * y[i];
  }
  double const d = s * sxx - sx * sx;
  WeightedLine out{(sxx * sy - sx * sxy) / d, (s * sxy - sx * sy) / d, std::sqrt(s / d), std::sqrt(sxx / d), 0};
  for (std::size_t i = 0; i < x.size(); ++i)
    out.chi_square += std::pow((y[i] - out.offset - out.slope * x[i]) / sigma[i], 2);
  return out;
}

}  // namespace straytrace
