// SPDX-License-Identifier: BSD-3-Clause
// Eigenmodes of cavities from their round-trip ray matrices: linear, folded, ring and twisted ones
// (docs/theory/beams.md, eq. 6.2; the closed forms of two mirrors are in beams/cavity_mode.hpp).
#pragma once

#include <array>
#include <span>
#include <string>

#include "beams/ray_matrix.hpp"

namespace straytrace::beams {

// Reason why the cavity is unstable; empty when it is stable.
std::string instability(AxisMatrix const& round_trip);
std::string instability(RayMatrix const& round_trip);

// The field that reproduces itself after a round trip. `gouy`: phase by which a mode of one order more along the axis
// lags per round trip, rad in [0, 2 pi); its distance in frequency is gouy/(2 pi) of the free spectral range.
// Left-right images of a ring with an odd number of mirrors are in it.
struct AxisEigenmode {
  BeamParameter q;  // over the index at the start of the round trip
  double gouy = 0;
};
struct RayEigenmode {
  Eigen::Matrix2cd n_q;             // n Q at the start of the round trip, 1/m
  std::array<double, 2> gouy = {};  // of x and y where these are independent
};
// Both throw NumericalError with the reason when the cavity is unstable or its mode is not unique.
AxisEigenmode eigenmode(AxisMatrix const& round_trip);
RayEigenmode eigenmode(RayMatrix const& round_trip);

// Cavity in space. `start` gives where the round trip begins, its frame and the wavelength in the medium there, of
// index `index`; its Q is not used. The elements lead back to its origin and direction.
struct CavityEigenmode {
  Mode mode;                        // at the start
  std::array<double, 2> gouy = {};  // as in RayEigenmode
  double tem00_gouy = 0;            // lag of TEM00 per round trip, rad, counted on without jumps
  double optical_length = 0;        // of the round trip, m
};
CavityEigenmode cavity_eigenmode(Mode const& start, double index, std::span<OpticalElement const>);

}  // namespace straytrace::beams
