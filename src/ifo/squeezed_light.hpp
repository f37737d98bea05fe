// SPDX-License-Identifier: BSD-3-Clause
// Squeezed vacuum, and what filter cavities make of it, at one Fourier frequency.
#pragma once

#include <Eigen/Core>

#include <vector>

#include "base/math/constants.hpp"

namespace straytrace {

// Of the two quadratures of a field, in units of the vacuum.
using QuadratureCovariance = Eigen::Matrix2cd;

QuadratureCovariance squeezed_vacuum(double least, double most, double angle = 0);  // noise powers; rad

struct FilterCavity {
  double length = not_a_number, detuning = not_a_number;                                           // m, Hz
  double input_transmission = not_a_number, end_transmission = not_a_number, loss = not_a_number;  // loss: round trip
  double rotation = 0;                                                                             // rad, after it
};

struct Squeezer {
  double decibels = 0, anti_decibels = not_a_number;  // NaN: as much as squeezing
  double angle = 0, loss = 0, phase_noise = 0;        // rad, power, rad rms
  std::vector<FilterCavity> cavities{};               // in the order the light meets them

  QuadratureCovariance covariance(double hz) const;  // after loss and cavities; the angle fluctuates by phase_noise
};

}  // namespace straytrace
