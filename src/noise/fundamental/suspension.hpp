// SPDX-License-Identifier: BSD-3-Clause
// Suspended test masses: response to ground motion, and thermal noise (docs/theory/sensitivity.md, eq. 12.9 for one
// stage).
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "noise/fundamental/detector.hpp"

namespace straytrace::noise {

constexpr double standard_gravity = 9.80665;  // m/s^2

// One direction of a chain of masses and lossy springs, at one frequency. Motion goes as exp(i w t).
struct ChainResponse {
  std::complex<double> from_top;    // test mass per displacement of the support of the chain
  std::complex<double> compliance;  // of the test mass, m/N
  double thermal_psd = 0;           // m^2/Hz of the test mass, one-sided
};
enum class Direction { horizontal, vertical };
// Horizontal: pendulums whose wires lose energy where they bend, dilution by gravity; the last stage with the violin
// modes of its fibres (Gonzalez and Saulson 1994). Vertical: blades, and the stretch of the fibres.
ChainResponse chain_response(SuspensionChain const&, Direction, double hz);

// Thermal noise along the beam of one test mass, m^2/Hz: horizontal, and vertical times the coupling squared.
double suspension_thermal_psd(SuspensionChain const&, double hz);
// |displacement along the beam per displacement of the platform|^2, both directions shaken alike and independently.
double seismic_transfer_squared(SuspensionChain const&, double hz);

}  // namespace straytrace::noise
