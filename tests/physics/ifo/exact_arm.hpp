// SPDX-License-Identifier: BSD-3-Clause
// Arm cavities in exact plane waves, on resonance.
#pragma once

#include <cmath>
#include <complex>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "ifo/fabry_perot_michelson.hpp"

namespace straytrace {

inline double power_gain(ArmCavity const& arm) {  // eq. 6.4
  return arm.input_transmission / std::pow(1 - arm.r1() * arm.r2(), 2);
}

// Length change of the arm [m] that would change the phase of the light returning to the splitter as much as the stray
// fields do: eq. 9.10. s_arm joins the round trip, s_in the light from the splitter.
inline double equivalent_length(ArmCavity const& arm, double wavelength, std::complex<double> s_arm,
                                std::complex<double> s_in) {
  double const r1 = arm.r1(), r2 = arm.r2(), t1 = std::sqrt(arm.input_transmission), k = 2 * pi / wavelength;
  std::complex<double> const inside = t1 * (1.0 + s_in) / (1 - r1 * r2 - s_arm);
  std::complex<double> const returned = -r1 * (1.0 + s_in) + t1 * (r2 + s_arm / r1) * inside;
  double const unperturbed = -r1 + t1 * t1 * r2 / (1 - r1 * r2);
  // d(returned)/d(round-trip phase) is imaginary on resonance: a pure change of phase.
  double const slope = 2 * k * t1 * t1 * r2 / std::pow(1 - r1 * r2, 2) / unperturbed;  // rad/m
  return std::arg(returned / unperturbed) / slope;
}

}  // namespace straytrace
